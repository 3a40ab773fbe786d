"""When the robot is stepped again without waiting for the next frame."""

from __future__ import annotations

import math

_SMOOTH = 0.1
_GAP_S = 0.2


class Ticks:
    """Between slow frames the robot moves on in even ticks of at least ``tick_hz``; fast frames are its ticks."""

    def __init__(self, tick_hz: float) -> None:
        self._tick_s = 1.0 / tick_hz
        self._interval_s = self._tick_s
        self._last_s: float | None = None
        self._step_s = self._tick_s
        self._between = 0
        self.due_s = 0.0

    def frame(self, received_s: float, now_s: float) -> None:
        """A frame, received then, was used up now. Gaps (a pause, a stutter) say nothing about the usual interval."""
        if self._last_s is not None and 0.0 < received_s - self._last_s < _GAP_S:
            self._interval_s += _SMOOTH * (received_s - self._last_s - self._interval_s)
        self._last_s = received_s
        parts = max(1, math.ceil(self._interval_s / self._tick_s - 0.25))
        self._step_s, self._between = self._interval_s / parts, parts - 1
        self.due_s = max(received_s + self._step_s + self._patience_s, now_s + 0.5 * self._tick_s)

    def tick(self, now_s: float) -> None:
        """A step without a frame was made now."""
        self._between -= 1
        step_s = self._step_s if self._between >= 0 else self._tick_s
        self.due_s = max(self.due_s + step_s + self._patience_s, now_s)

    @property
    def _patience_s(self) -> float:
        """The step at which a frame is due waits for it by half a tick before it counts as missing."""
        return 0.5 * self._tick_s if self._between == 0 else 0.0
