"""Frames of the bench session played from memory, as a sensor gives them."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from dataclasses import replace

from benchmarks.bench_chain import session
from teleop.frames import DepthFrame
from teleop.recording import McapSource
from teleop.sources.base import SourceInfo

FPS = 30


class MemoryLoop:
    """Forwards and backwards without end, at 30 frames/s by the clock with new stamps; a late frame is not left out.

    Colour comes as a sensor gives it, without its JPEG.
    """

    def __init__(self, frames: list[DepthFrame], info: SourceInfo) -> None:
        self.info = replace(info, live=True, uri="memory:", kind="memory", frame_count=None, duration_s=None)
        self._round = frames + frames[-2:0:-1]
        self._stopped = threading.Event()
        self.given = 0

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:  # noqa: ARG002
        """Until ``close``."""
        begin_s = time.monotonic()
        while not self._stopped.is_set():
            frame = self._round[self.given % len(self._round)]
            t_ns = round(self.given * 1e9 / FPS)
            if self._stopped.wait(max(0.0, begin_s + t_ns * 1e-9 - time.monotonic())):
                return
            self.given += 1
            yield replace(frame, t_ns=t_ns, seq=self.given, color_jpeg=None)

    def close(self) -> None:
        """End the frames."""
        self._stopped.set()


def memory_loop(seconds: float) -> MemoryLoop:
    """The first seconds of the bench session: 640x480, depth and colour."""
    source = McapSource(session())
    frames: list[DepthFrame] = []
    for frame in source.frames():
        if frames and frame.t_ns - frames[0].t_ns > seconds * 1e9:
            break
        frames.append(frame)
    source.close()
    return MemoryLoop(frames, source.info)
