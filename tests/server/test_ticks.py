"""Even steps of the robot between slow frames, by a clock of our own."""

from __future__ import annotations

from itertools import pairwise

import pytest

from server.engine.ticks import Ticks


def steps(fps: float, seconds: float = 4.0) -> list[float]:
    """Times of all steps, with frames or without, of frames that are used up in 10 ms."""
    ticks, times = Ticks(30.0), []
    for i in range(int(fps * seconds)):
        at_s, next_s = 1.0 + i / fps, 1.0 + (i + 1) / fps
        times.append(at_s)
        ticks.frame(at_s, at_s + 0.010)
        while ticks.due_s < next_s:
            times.append(ticks.due_s)
            ticks.tick(ticks.due_s)
    return [t for t in times if t > 3.0]


@pytest.mark.parametrize(("fps", "rate_hz"), [(30.0, 30.0), (25.0, 25.0), (20.0, 40.0), (15.0, 30.0), (10.0, 30.0)])
def test_slow_frames_are_filled_up_evenly_and_fast_ones_are_left_alone(fps: float, rate_hz: float) -> None:
    times = steps(fps)
    gaps_s = [b - a for a, b in pairwise(times)]
    assert len(gaps_s) / (times[-1] - times[0]) == pytest.approx(rate_hz, rel=0.05)
    assert max(gaps_s) < 1.3 / min(rate_hz, 30.0)


def test_a_missing_frame_is_stepped_over() -> None:
    ticks = Ticks(30.0)
    ticks.frame(1.0, 1.010)
    first_s = ticks.due_s
    ticks.tick(first_s)
    assert first_s == pytest.approx(1.05) and ticks.due_s == pytest.approx(1.05 + 1 / 30)
