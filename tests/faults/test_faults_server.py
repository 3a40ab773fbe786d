"""Faults through the running server, the real tracker and PyBullet; ``python -m benchmarks faults`` runs all."""

from collections.abc import Iterator

import pytest

from benchmarks.faults.scenarios import FAULTS, run, smallest_gap_m
from benchmarks.faults.stage import Stage, stage
from teleop.intent_types import Mode

CHOSEN = (
    ("every other frame reordered", "picking"),
    ("joints NaN", "picking"),
    ("blank frames", "forward"),
    ("camera unplugged", "forward"),
    ("emergency stop", "spraying"),
)


@pytest.fixture(scope="module")
def on() -> Iterator[Stage]:
    with stage() as running:
        yield running
        assert running.watch.limits.range_rad < 0.02, "no joint beyond its range"
        assert running.watch.limits.speed < 1.2, "nor faster than it may, but for the servo's own overshoot"
        assert running.watch.limits.chassis < 1.2
        assert smallest_gap_m(running) > 0.0


@pytest.mark.parametrize(("name", "mode"), CHOSEN)
def test_the_robot_does_what_it_must(on: Stage, name: str, mode: str) -> None:
    fault = next(f for f in FAULTS if (f.name, f.mode) == (name, mode))
    outcome = run(on, fault)
    assert outcome.fulfilled, outcome


def test_every_fault_of_the_list_is_there() -> None:
    modes = {f.mode for f in FAULTS if f.name == "emergency stop"}
    assert modes == {mode.value for mode in Mode}
    assert len(FAULTS) >= 40
    assert all(f.reasons for f in FAULTS if f.must == "still"), "whatever stops the robot says why"
