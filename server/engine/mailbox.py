"""One slot between the source's thread and the engine's: live frames replace each other, recorded ones wait."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, replace

from teleop.frames import DepthFrame
from teleop.recording.recorded import RecordedPose


@dataclass(frozen=True, slots=True)
class Arrived:
    """A frame with the server's own clock.

    received_s: monotonic time of receipt. position_s: since the first frame of the source.
    restarted: the recording began again before this frame. recorded: where the robot was at this frame, if known.
    in_control: just after a jump, whether the operator was in control there when it was recorded.
    """

    frame: DepthFrame
    received_s: float
    position_s: float
    restarted: bool = False
    recorded: RecordedPose | None = None
    in_control: bool = False


class Mailbox:
    """Thread-safe slot of size one."""

    def __init__(self) -> None:
        self._ready = threading.Condition()
        self._slot: Arrived | None = None
        self._woken = False
        self.dropped = 0

    def put(self, arrived: Arrived) -> None:
        """Leave a frame; one that nobody took is replaced, but a restart it announced is kept."""
        with self._ready:
            if self._slot is not None:
                self.dropped += 1
                if self._slot.restarted and not arrived.restarted:
                    arrived = replace(arrived, restarted=True)
            self._slot = arrived
            self._ready.notify_all()

    def hand_over(self, arrived: Arrived, given_up: Callable[[], bool]) -> None:
        """Leave a frame that must not be lost: waits until the one before it is taken, or until it is given up."""
        with self._ready:
            self._ready.wait_for(lambda: self._slot is None or given_up())
            if not given_up():
                self._slot = arrived
            self._ready.notify_all()

    def wake(self) -> None:
        """Make :meth:`take` return now."""
        with self._ready:
            self._woken = True
            self._ready.notify_all()

    def clear(self) -> None:
        """Forget a waiting frame (its source is gone)."""
        with self._ready:
            self._slot = None
            self._ready.notify_all()

    def take(self, timeout_s: float) -> Arrived | None:
        """The newest frame; None after ``timeout_s`` or when woken."""
        with self._ready:
            self._ready.wait_for(lambda: self._slot is not None or self._woken, max(0.0, timeout_s))
            arrived, self._slot, self._woken = self._slot, None, False
            self._ready.notify_all()
            return arrived
