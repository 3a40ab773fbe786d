"""A sensor that goes away and comes back: stamps carried on, faults told, another camera refused."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest

from teleop.errors import SourceError
from teleop.frames import Camera, DepthFrame, Intrinsics
from teleop.sources.base import SourceInfo
from teleop.sources.reconnect import Reconnecting
from teleop.sources.statistics import FrameStatistics

CAMERA = Camera(Intrinsics(5.0, 5.0, 3.5, 2.5, 8, 6))
PERIOD_NS = 33_000_000


class Plugged:
    """Three frames, stamped from zero, then the cable is pulled."""

    def __init__(self, camera: Camera = CAMERA, error: str | None = "pulled") -> None:
        self.info = SourceInfo("test:", "test", camera, live=True)
        self.closed = 0
        self._error = error

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:
        for i in range(3):
            yield DepthFrame(i * PERIOD_NS, np.zeros((6, 8), np.uint16), self.info.camera, None, i)
        if self._error:
            raise SourceError(self._error)

    def close(self) -> None:
        self.closed += 1


class Clock:
    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        self.now_s += 0.05
        return self.now_s


def test_frames_go_on_with_increasing_times() -> None:
    tries: list[Plugged | None] = [None, Plugged(error=None), None, None, Plugged()]
    faults: list[str | None] = []

    def open_again() -> Plugged:
        source = tries.pop(0)
        if source is None:
            raise SourceError("no device found")
        return source

    first = Plugged()
    source = Reconnecting(first, open_again, retry_s=0.001, clock=Clock())
    source.on_change = lambda: faults.append(source.fault)
    taken: list[DepthFrame] = []
    for frame in source.frames():
        taken.append(frame)
        if len(taken) == 9:
            source.close()
    assert len(taken) == 9 and source.interruptions == 2
    assert all(b.t_ns > a.t_ns for a, b in pairwise(taken))
    away_ns = taken[3].t_ns - taken[2].t_ns
    assert away_ns > PERIOD_NS  # as long as the sensor was away
    assert taken[4].t_ns - taken[3].t_ns == PERIOD_NS
    assert faults == ["pulled", None, "the sensor gives no more frames", None]
    assert first.closed and not tries


def test_another_camera_is_refused() -> None:
    other = Camera(Intrinsics(6.0, 6.0, 3.5, 2.5, 8, 6))
    source = Reconnecting(Plugged(), lambda: Plugged(other), retry_s=0.001)
    with pytest.raises(SourceError, match="test: came back as another camera"):
        list(source.frames())


def test_closing_ends_the_waiting() -> None:
    def never() -> Plugged:
        source.close()
        raise SourceError("no device found")

    source = Reconnecting(Plugged(), never, retry_s=0.001)
    assert len(list(source.frames())) == 3
    assert source.fault == "pulled"


def test_statistics_of_frames() -> None:
    statistics = FrameStatistics()
    depth = np.zeros((6, 8), np.uint16)
    depth[:3] = 900
    numbers = [i for i in range(70) if i not in (40, 41, 50)]
    for i in numbers[:60]:
        statistics.add(DepthFrame(i * PERIOD_NS, depth, CAMERA, None, i), i * 0.033)
    counts = statistics.counts
    assert (counts.frames, counts.lost, counts.color_frames) == (60, 3, 0)
    assert counts.rate_hz == pytest.approx(30.3, abs=0.1)
    assert counts.longest_gap_s == pytest.approx(0.099) and counts.jitter_ms > 5
    assert counts.valid == 0.5
    statistics.interrupted()
    for i in range(30):
        statistics.add(DepthFrame(9_000_000_000 + i * PERIOD_NS, depth, CAMERA), 90.0 + i * 0.033)
    assert (statistics.counts.frames, statistics.counts.lost) == (90, 3)
