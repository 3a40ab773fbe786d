"""A live source that comes back by itself: lost, waited for, opened again, its stamps carried on."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace

from teleop.errors import SourceError, TeleopError
from teleop.frames import DepthFrame
from teleop.sources.base import Source, SourceInfo
from teleop.sources.uri import open_source

_LEAST_STEP_NS = 1_000_000


class Reconnecting:
    """Frames of a sensor across interruptions; ``fault`` says why none come just now. Closing ends the waiting."""

    def __init__(
        self,
        source: Source,
        open_again: Callable[[], Source],
        retry_s: float,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """source: open, owned from now on. open_again: opens the same one, or raises. retry_s: between two tries."""
        self._source = source
        self._open_again = open_again
        self._retry_s = retry_s
        self._clock = clock
        self._info = source.info
        self._closed = threading.Event()
        self._switching = threading.Lock()
        self._last_ns: int | None = None
        self._last_s = clock()
        self._offset_ns = 0
        self.fault: str | None = None
        """Why no frames come, None while they do."""
        self.interruptions = 0
        self.on_change: Callable[[], None] = _nobody
        """Called, from the reading thread, when ``fault`` begins or ends."""

    @property
    def info(self) -> SourceInfo:
        """What was known of the source when it was first opened."""
        return self._info

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:  # noqa: ARG002
        """Frames with increasing times. Raises SourceError only when the sensor comes back as another one."""
        while not self._closed.is_set():
            why = "the sensor gives no more frames"
            fresh = True
            try:
                for frame in self._source.frames():
                    yield self._carried_on(frame, fresh)
                    fresh = False
            except TeleopError as error:
                why = str(error)
            if self._closed.is_set():
                return
            self._lost(why)
            self._wait_for_it()

    def close(self) -> None:
        """Release the device, or stop waiting for it; safe to call twice, from any thread."""
        self._closed.set()
        with self._switching:
            self._source.close()

    def _carried_on(self, frame: DepthFrame, fresh: bool) -> DepthFrame:
        """The frame with a stamp behind the last one's; a sensor may count from zero again."""
        now_s = self._clock()
        if fresh and self._last_ns is not None:
            away_ns = max(round((now_s - self._last_s) * 1e9), _LEAST_STEP_NS)
            self._offset_ns = self._last_ns + away_ns - frame.t_ns
        if self.fault is not None:
            self.fault = None
            self.on_change()
        if self._offset_ns:
            frame = replace(frame, t_ns=frame.t_ns + self._offset_ns)
        self._last_ns, self._last_s = frame.t_ns, now_s
        return frame

    def _lost(self, why: str) -> None:
        self.interruptions += 1
        self.fault = why
        self.on_change()

    def _wait_for_it(self) -> None:
        while not self._closed.is_set():
            with self._switching:
                self._source.close()
            if self._closed.wait(self._retry_s):
                return
            try:
                source = self._open_again()
            except TeleopError:
                continue  # the fault of the moment it was lost says more than "no device found"
            with self._switching:
                self._source = source
                if self._closed.is_set():
                    source.close()
                    return
            if source.info.camera != self._info.camera:
                raise SourceError(f"{self._info.uri} came back as another camera; open it again")
            return


def open_lasting(uri: str, retry_s: float) -> Source:
    """Open any source; a sensor comes back by itself when it is lost. Raises TeleopError."""
    source = open_source(uri)
    is_sensor = source.info.live and source.info.kind != "virtual"
    return Reconnecting(source, lambda: open_source(uri), retry_s) if is_sensor else source


def _nobody() -> None:
    return
