"""Picking or spraying, and the head camera, from the legs."""

from itertools import pairwise

import numpy as np
import pytest
from stick_figure import Person, skeleton

from teleop.angles import leg_angles
from teleop.config.intent import AngleConfig, TaskConfig
from teleop.intent_types import Mode
from teleop.task import TaskState, step_task

CONFIG = TaskConfig()
DT_S = 1 / 30


def tasks(T1: list[float], T2: float = 0.0) -> list[Mode | None]:
    state, out = TaskState(), []
    for value in T1:
        state = step_task(state, value, T2, DT_S, CONFIG)
        out.append(state.task)
    return out


@pytest.mark.parametrize(
    ("T1", "task"), [(5.0, Mode.SPRAYING), (11.0, Mode.SPRAYING), (13.0, Mode.PICKING), (30.0, Mode.PICKING)]
)
def test_legs_decide(T1: float, task: Mode) -> None:
    assert tasks([T1] * 90)[-1] is task


def test_clear_change_is_quick() -> None:
    out = tasks([3.0] * 60 + [25.0] * 60)
    assert (out.index(Mode.PICKING) - 60) * DT_S <= 0.2


@pytest.mark.parametrize("apart_deg", [12.0, 12.0 - CONFIG.margin_deg, 12.0 + CONFIG.margin_deg])
def test_standing_on_the_threshold_for_a_minute_never_flips(apart_deg: float) -> None:
    rng = np.random.default_rng(11)
    for start in (20.0, 3.0):
        T1 = [start] * 60
        T1 += [leg_angles(skeleton(Person(legs_apart_deg=apart_deg), rng=rng), AngleConfig())[0] for _ in range(1800)]
        out = tasks(T1)[60:]
        # a threshold's own edge may be crossed once, never to and fro
        changes = sum(a is not b for a, b in pairwise(out))
        assert changes <= (0 if apart_deg == 12.0 else 1)


def test_unknown_legs_change_nothing() -> None:
    state = step_task(TaskState(), None, None, DT_S, CONFIG)
    assert state.task is None


def test_head_camera_starts_after_four_seconds_and_stops() -> None:
    state, started, stopped = TaskState(), None, None
    for i in range(400):
        state = step_task(state, 5.0, 25.0 if i < 200 else 2.0, DT_S, CONFIG)
        if state.head_camera_sweep and started is None:
            started = i * DT_S
        if started is not None and not state.head_camera_sweep and stopped is None:
            stopped = i * DT_S
    assert started == pytest.approx(4.0, abs=0.35)
    assert started >= 4.0
    assert stopped == pytest.approx(200 * DT_S, abs=0.35)


def test_head_camera_stays_for_a_short_stride() -> None:
    state = TaskState()
    for i in range(300):
        state = step_task(state, 5.0, 25.0 if i % 90 < 80 else 0.0, DT_S, CONFIG)
        assert not state.head_camera_sweep


def test_legs_that_hardly_tremble_decide_sooner() -> None:
    def delay_s(noise_deg: float) -> float:
        rng = np.random.default_rng(3)
        T1 = np.interp(np.arange(120), [60, 68], [4.0, 17.0]) + rng.normal(0.0, noise_deg, 120)
        return (tasks(list(T1)).index(Mode.PICKING) - 60) * DT_S

    assert delay_s(0.3) <= 0.35
    assert delay_s(CONFIG.noise_deg) > 1.5 * delay_s(0.3)


def test_noise_that_begins_on_the_threshold_does_not_flip() -> None:
    for seed in range(40):
        noise = np.random.default_rng(seed).normal(0.0, CONFIG.noise_deg, 300)
        for start, task in ((9.0, Mode.SPRAYING), (15.0, Mode.PICKING)):
            out = tasks([start] * 60 + list(12.0 + noise))
            assert set(out[60:]) == {task}, seed
