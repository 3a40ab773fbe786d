"""Frames handed in by somebody else: the server feeds what arrives over its websocket."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Iterator

from teleop.errors import SourceError
from teleop.frames import Camera, DepthFrame
from teleop.sources.base import SourceInfo

_WAIT_S = 0.1


class PushSource:
    """A bounded queue between one feeding thread and one reading thread; the oldest frame gives way.

    ``dropped`` counts frames that were not read in time.
    """

    def __init__(self, camera: Camera, *, has_color: bool = False, capacity: int = 4) -> None:
        self._info = SourceInfo(uri="push:", kind="push", camera=camera, live=True, has_color=has_color)
        self._queue: deque[DepthFrame] = deque()
        self._capacity = capacity
        self._changed = threading.Condition()
        self._closed = False
        self.dropped = 0

    @property
    def info(self) -> SourceInfo:
        """The camera the sender announced."""
        return self._info

    def feed(self, frame: DepthFrame) -> bool:
        """Hand in one frame, from any thread; False when the source is closed.

        Frames that come twice, late or out of order are handed on: the safety kernel refuses them, with a reason, and
        begins anew when the sender's clock was set back.

        Raises SourceError when the frame comes from another camera than the announced one.
        """
        if frame.camera != self._info.camera:
            raise SourceError("the pushed frame's camera differs from the announced one; connect again to change it")
        with self._changed:
            if self._closed:
                return False
            if len(self._queue) == self._capacity:
                self._queue.popleft()
                self.dropped += 1
            self._queue.append(frame)
            self._changed.notify()
        return True

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:  # noqa: ARG002
        """Frames as they come, until ``close``."""
        while True:
            with self._changed:
                while not self._queue and not self._closed:
                    self._changed.wait(_WAIT_S)
                if not self._queue:
                    return
                frame = self._queue.popleft()
            yield frame

    def close(self) -> None:
        """End ``frames`` after what is queued; safe to call twice, from any thread."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
