"""The queue behind push: one thread feeds, one reads."""

from __future__ import annotations

import threading

import numpy as np
import pytest

from teleop.errors import SourceError
from teleop.frames import Camera, DepthFrame, Intrinsics
from teleop.sources.live import TickClock
from teleop.sources.push import PushSource

CAMERA = Camera(Intrinsics(5.0, 5.0, 3.5, 2.5, 8, 6))


def frame(t_ns: int, camera: Camera = CAMERA) -> DepthFrame:
    return DepthFrame(t_ns, np.full((6, 8), t_ns % 60000, np.uint16), camera)


def test_frames_pass_between_threads() -> None:
    source = PushSource(CAMERA, capacity=1000)
    read: list[int] = []
    reader = threading.Thread(target=lambda: read.extend(f.t_ns for f in source.frames()))
    reader.start()
    for t in range(500):
        assert source.feed(frame(t))
    source.close()
    reader.join(timeout=30)
    assert not reader.is_alive()
    assert read == list(range(500))
    assert source.dropped == 0


def test_the_oldest_gives_way_and_is_counted() -> None:
    source = PushSource(CAMERA, capacity=3)
    for t in range(10):
        source.feed(frame(t))
    source.close()
    assert [f.t_ns for f in source.frames()] == [7, 8, 9]
    assert source.dropped == 7


def test_old_foreign_and_late_frames() -> None:
    source = PushSource(CAMERA)
    assert source.feed(frame(5))
    assert source.feed(frame(5)) and source.feed(frame(4)), "the kernel refuses them, with a reason"
    with pytest.raises(SourceError, match="camera differs"):
        source.feed(frame(6, Camera(CAMERA.depth, mirrored=True)))
    source.close()
    source.close()
    assert not source.feed(frame(7))
    assert [f.t_ns for f in source.frames()] == [5, 5, 4]


def test_device_ticks_unwrap() -> None:
    clock = TickClock(60_000_000)
    start = 2**32 - 60_000_000
    assert clock.t_ns(start) == 0
    assert clock.t_ns(0) == 1_000_000_000
    assert clock.t_ns(30_000_000) == 1_500_000_000
    assert clock.t_ns(0) == 1_000_000_000
