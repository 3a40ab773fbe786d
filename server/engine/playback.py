"""Replay controls of a recorded source: play, pause, step, seek, speed, loop; and when the next frame is due."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

from server.errors import Refused

SPEED_RANGE = (0.1, 8.0)
SLIP_S = 0.1
"""A replay later than this goes on from where it is instead of catching up."""


class Turn(StrEnum):
    """What the reader does with the frame it holds."""

    DELIVER = "deliver"
    SEEK = "seek"
    STOP = "stop"


@dataclass(frozen=True, slots=True)
class Pace:
    """The recording's position as a function of the server's clock: position = position_s + (now - wall_s) speed."""

    wall_s: float
    position_s: float
    speed: float = 1.0

    def due_s(self, position_s: float) -> float:
        """Wall time at which ``position_s`` is reached."""
        return self.wall_s + (position_s - self.position_s) / self.speed


@dataclass(frozen=True, slots=True)
class PlaybackState:
    """A snapshot for the console."""

    paused: bool = False
    ended: bool = False
    position_s: float = 0.0
    speed: float = 1.0
    loop: bool = False


class Playback:
    """Thread-safe: controls come from HTTP, the reader waits in :meth:`turn`."""

    def __init__(self, loop: bool, duration_s: float | None, clock: Callable[[], float] = time.monotonic) -> None:
        self._changed = threading.Condition()
        self._clock = clock
        self._duration_s = duration_s
        self._state = PlaybackState(loop=loop)
        self._pace = Pace(clock(), 0.0)
        self._target_s: float | None = None
        self._show_one = False
        self._stopped = False

    @property
    def state(self) -> PlaybackState:
        """What the console shows."""
        with self._changed:
            return self._state

    def play(self) -> None:
        """Go on; from the beginning when the end was reached."""
        with self._changed:
            if self._state.ended:
                self._target_s = 0.0
            self._update(replace(self._state, paused=False, ended=False))

    def pause(self) -> None:
        """Stand still at the present frame."""
        with self._changed:
            self._update(replace(self._state, paused=True))

    def step(self) -> None:
        """Pause, and show the one frame that comes next."""
        with self._changed:
            self._show_one = True
            self._update(replace(self._state, paused=True))

    def seek(self, position_s: float) -> None:
        """Jump; while paused the frame at the new position is still shown. Raises Refused outside the recording."""
        end = self._duration_s if self._duration_s is not None else math.inf
        if not 0.0 <= position_s <= end:
            raise Refused(
                422, f"position_s: {position_s:g} is outside the recording; legal: 0 <= position_s <= {end:g}"
            )
        with self._changed:
            self._target_s = position_s
            self._show_one = True
            self._update(replace(self._state, position_s=position_s, ended=False))

    def set_speed(self, speed: float) -> None:
        """Play faster or slower. Raises Refused outside 0.1..8."""
        low, high = SPEED_RANGE
        if not low <= speed <= high:
            raise Refused(422, f"speed: {speed:g} is out of range; legal: {low:g} <= speed <= {high:g}")
        with self._changed:
            self._update(replace(self._state, speed=speed))

    def set_loop(self, loop: bool) -> None:
        """Begin again at the end, or not; a replay that has ended waits for play either way."""
        with self._changed:
            self._state = replace(self._state, loop=loop)

    def stop(self) -> None:
        """Release the reader for good."""
        with self._changed:
            self._stopped = True
            self._changed.notify_all()

    def turn(self, position_s: float) -> Turn:
        """Wait until the frame at ``position_s`` is due and say what to do with it (reader's thread)."""
        with self._changed:
            while True:
                if self._stopped:
                    return Turn.STOP
                if self._target_s is not None:
                    return Turn.SEEK
                wait_s = math.inf if self._state.paused else self._pace.due_s(position_s) - self._clock()
                if self._show_one or wait_s <= 0.0:
                    self._show_one = False
                    self._state = replace(self._state, position_s=position_s)
                    if -wait_s > SLIP_S:  # fell behind (busy or suspended machine): do not race
                        self._pace = Pace(self._clock(), position_s, self._state.speed)
                    return Turn.DELIVER
                self._changed.wait(None if math.isinf(wait_s) else wait_s)

    def start_at(self) -> float:
        """Take the seek target and restart the pace there (reader's thread)."""
        with self._changed:
            target, self._target_s = self._target_s or 0.0, None
            self._pace = Pace(self._clock(), target, self._state.speed)
            return target

    def end(self) -> Turn:
        """The last frame is out: loop, or wait for a control (reader's thread). SEEK means read on at start_at()."""
        with self._changed:
            if self._state.loop and not self._stopped:
                self._target_s = 0.0
                return Turn.SEEK
            self._state = replace(self._state, ended=True)
            while self._target_s is None and not self._stopped:
                self._changed.wait()
            return Turn.STOP if self._stopped else Turn.SEEK

    def _update(self, state: PlaybackState) -> None:
        """Change the state and let the pace go on from the present position."""
        self._state = state
        self._pace = Pace(self._clock(), state.position_s, state.speed)
        self._changed.notify_all()
