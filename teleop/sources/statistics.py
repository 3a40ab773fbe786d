"""How regularly frames come: counts, rate, jitter, losses. Told every frame; times come in as arguments."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from teleop.frames import DepthFrame

WINDOW = 150
"""Frames that rate and jitter look back on: five seconds at 30 frames/s."""
_GAP = 1.5
"""Two stamps further apart than this many periods have frames missing between them."""


@dataclass(frozen=True, slots=True)
class FrameCounts:
    """frames: received. lost: missing by their stamps. rate_hz, jitter_ms: of the stamps and of the receive times.

    longest_gap_s: between two receive times. valid: share of pixels with a reading in the last frame.
    """

    frames: int = 0
    lost: int = 0
    color_frames: int = 0
    rate_hz: float = 0.0
    jitter_ms: float = 0.0
    longest_gap_s: float = 0.0
    valid: float = 0.0


class FrameStatistics:
    """One writer; ``counts`` may be read from any thread."""

    def __init__(self) -> None:
        self._stamps_ns: deque[int] = deque(maxlen=WINDOW)
        self._received_s: deque[float] = deque(maxlen=WINDOW)
        self._frames = self._lost = self._color_frames = 0
        self._longest_gap_s = 0.0
        self._period_ns = 0.0
        self._last: DepthFrame | None = None
        self.counts = FrameCounts()

    def add(self, frame: DepthFrame, received_s: float) -> None:
        """Count one frame."""
        if self._stamps_ns:
            step_ns = frame.t_ns - self._stamps_ns[-1]
            self._longest_gap_s = max(self._longest_gap_s, received_s - self._received_s[-1])
            if self._period_ns > 0 and step_ns > _GAP * self._period_ns:
                self._lost += round(step_ns / self._period_ns) - 1
        self._frames += 1
        self._last = frame
        self._color_frames += frame.color_rgb is not None
        self._stamps_ns.append(frame.t_ns)
        self._received_s.append(received_s)
        if self._frames % 30 == 0 or self._frames in (2, 5, 10):
            self._summarise(frame)

    def finished(self) -> FrameCounts:
        """The counts with the last frame in them."""
        if self._last is not None:
            self._summarise(self._last)
        return self.counts

    def interrupted(self) -> None:
        """The source went away: what comes next follows no earlier frame."""
        self._stamps_ns.clear()
        self._received_s.clear()

    def _summarise(self, frame: DepthFrame) -> None:
        stamps = np.diff(np.array(self._stamps_ns, dtype=np.int64))
        received = np.diff(np.array(self._received_s))
        if len(stamps):
            self._period_ns = float(np.median(stamps))
        self.counts = FrameCounts(
            frames=self._frames,
            lost=self._lost,
            color_frames=self._color_frames,
            rate_hz=round(1e9 / self._period_ns, 2) if self._period_ns > 0 else 0.0,
            jitter_ms=round(float(received.std()) * 1e3, 2) if len(received) else 0.0,
            longest_gap_s=round(self._longest_gap_s, 3),
            valid=round(float(np.count_nonzero(frame.depth_mm)) / frame.depth_mm.size, 3),
        )
