"""One slot between the source's thread and the engine's: the newest frame wins, the older one is counted as dropped."""

from __future__ import annotations

import threading
from dataclasses import dataclass

from teleop.frames import DepthFrame


@dataclass(frozen=True, slots=True)
class Arrived:
    """A frame with the server's own clock.

    received_s: monotonic time of receipt. position_s: since the first frame of the source.
    restarted: the recording began again before this frame.
    """

    frame: DepthFrame
    received_s: float
    position_s: float
    restarted: bool = False


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
                    arrived = Arrived(arrived.frame, arrived.received_s, arrived.position_s, restarted=True)
            self._slot = arrived
            self._ready.notify()

    def wake(self) -> None:
        """Make :meth:`take` return now."""
        with self._ready:
            self._woken = True
            self._ready.notify()

    def clear(self) -> None:
        """Forget a waiting frame (its source is gone)."""
        with self._ready:
            self._slot = None

    def take(self, timeout_s: float) -> Arrived | None:
        """The newest frame; None after ``timeout_s`` or when woken."""
        with self._ready:
            self._ready.wait_for(lambda: self._slot is not None or self._woken, max(0.0, timeout_s))
            arrived, self._slot, self._woken = self._slot, None, False
            return arrived
