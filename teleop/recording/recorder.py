"""Recording off the hot path: a bounded queue before the writer, and a thread of its own behind it.

Under pressure colour and skeletons give way first, then depth; events, inputs and track rows never do. What begins
to give way is reported as an event, and when the pressure is over how much of each is missing. What was written is on
the disk within ``flush_s`` also when nothing follows it. A write error ends the recording, never the teleoperation.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Self

from robot_sim.state import RobotState
from teleop.errors import RecordingError
from teleop.frames import DepthFrame
from teleop.intent_types import Event
from teleop.recording.writer import McapWriter
from teleop.skeleton import Skeleton

REASON_DROPPED = "recording.dropped"
REASON_STOPPED = "recording.stopped"
CAPACITY_FRAMES = 60
"""Two seconds at 30 frames/s; about 90 MB at 640x480 with colour."""


@dataclass(frozen=True, slots=True)
class RecorderStatus:
    """Counts since the start. error: why the recording ended by itself, or None."""

    frames_written: int
    frames_dropped: int
    colors_dropped: int
    skeletons_dropped: int
    frames_queued: int
    error: str | None


class AsyncRecorder:
    """A McapWriter behind a queue; the ``write_`` methods return at once and never raise. One or more callers."""

    def __init__(
        self,
        writer: McapWriter,
        *,
        capacity: int = CAPACITY_FRAMES,
        on_event: Callable[[Event], None] | None = None,
        lossless: bool = False,
        flush_s: float = 1.0,
    ) -> None:
        """writer: open, owned from now on. capacity: frames held back. on_event: called from the writing thread.

        lossless: ``write_frame`` waits instead of dropping, for sources that wait too.
        """
        self._writer = writer
        self._capacity = capacity
        self._lossless = lossless
        self._flush_s = flush_s
        self._on_event = on_event
        self._work: deque[tuple[bool, int, Callable[[], None]]] = deque()
        self._changed = threading.Condition()
        self._frames_queued = 0
        self._frames_written = 0
        self._frames_dropped = 0
        self._colors_dropped = 0
        self._skeletons_dropped = 0
        self._missing: dict[str, int] = {}
        self._missing_ns = 0
        self._unflushed_since_s: float | None = None
        self._error: str | None = None
        self._closing = False
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)
        self._thread.start()

    @property
    def status(self) -> RecorderStatus:
        """A consistent snapshot."""
        with self._changed:
            return RecorderStatus(
                self._frames_written,
                self._frames_dropped,
                self._colors_dropped,
                self._skeletons_dropped,
                self._frames_queued,
                self._error,
            )

    @property
    def thread_id(self) -> int | None:
        """The system's number of the writing thread."""
        return self._thread.native_id

    def write_frame(self, frame: DepthFrame) -> bool:
        """Depth is dropped only when the queue is full; colour from half full on. Whether depth is kept."""
        with self._changed:
            if self._lossless:
                self._changed.wait_for(lambda: not self._pressed())
            if self._frames_queued >= self._capacity:
                self._frames_dropped += 1
                self._report_drop(frame.t_ns, "depth")
                return False
            if frame.color_rgb is not None and self._pressed():
                frame = frame.without_color()
                self._colors_dropped += 1
                self._report_drop(frame.t_ns, "colour")
            return self._put(True, frame.t_ns, lambda: self._writer.write_frame(frame))

    def write_skeleton(self, t_ns: int, skeleton: Skeleton | None) -> None:
        """Dropped from half full on: the track rows hold the same joints."""
        with self._changed:
            if self._pressed():
                self._skeletons_dropped += 1
                self._report_drop(t_ns, "skeletons")
                return
            self._put(False, t_ns, lambda: self._writer.write_skeleton(t_ns, skeleton))

    def write_row(self, t_ns: int, row: Mapping[str, Any]) -> None:
        """One row of ``teleop track``; never dropped."""
        self._keep(t_ns, lambda: self._writer.write_row(t_ns, row))

    def write_robot(self, t_ns: int, state: RobotState) -> None:
        """Robot state; never dropped."""
        self._keep(t_ns, lambda: self._writer.write_robot(t_ns, state))

    def write_event(self, event: Event) -> None:
        """An event; never dropped."""
        self._keep(event.t_ns, lambda: self._writer.write_event(event))

    def write_input(self, t_ns: int, data: Mapping[str, Any]) -> None:
        """An input of replay; never dropped."""
        self._keep(t_ns, lambda: self._writer.write_input(t_ns, data))

    def close(self, timeout_s: float = 30.0) -> RecorderStatus:
        """Write what is queued and close the file; safe to call twice."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        self._thread.join(timeout_s)
        if self._thread.is_alive():
            self._stop(0, f"the disk did not take the rest of {self._writer.path} within {timeout_s:.0f} s")
        return self.status

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _pressed(self) -> bool:
        return self._frames_queued >= self._capacity // 2

    def _keep(self, t_ns: int, work: Callable[[], None]) -> None:
        with self._changed:
            self._put(False, t_ns, work)

    def _put(self, is_frame: bool, t_ns: int, work: Callable[[], None]) -> bool:
        """Queue one write; the lock is held. After an error or ``close`` it is left out: the status says so."""
        if self._error is not None or self._closing:
            return False
        self._work.append((is_frame, t_ns, work))
        self._frames_queued += is_frame
        self._changed.notify_all()
        return True

    def _report_drop(self, t_ns: int, what: str) -> None:
        """Count a loss; the first of its kind in a stretch of pressure queues an event. The lock is held."""
        self._missing[what] = self._missing.get(what, 0) + 1
        self._missing_ns = t_ns
        if self._missing[what] == 1:
            event = Event(t_ns, "recording", REASON_DROPPED, f"{what} left out: the disk is slower than the camera")
            self._put(False, t_ns, lambda: self._announce(event))

    def _end_of_pressure(self) -> Event | None:
        """What is missing since the pressure began, once it is over; the lock is held."""
        if self._work or not self._missing:
            return None
        told = ", ".join(f"{what} {count}" for what, count in self._missing.items())
        self._missing = {}
        return Event(self._missing_ns, "recording", REASON_DROPPED, f"in all left out: {told}")

    def _announce(self, event: Event) -> None:
        self._writer.write_event(event)
        self._tell(event)

    def _tell(self, event: Event) -> None:
        if self._on_event is not None:
            self._on_event(event)

    def _run(self) -> None:
        t_ns = 0
        try:
            while (item := self._next()) is not None:
                is_frame, t_ns, work = item
                work()
                with self._changed:
                    self._frames_queued -= is_frame
                    self._frames_written += is_frame
                    over = self._end_of_pressure()
                    self._changed.notify_all()
                if over is not None:
                    self._announce(over)
                self._flush_if_due()
            self._writer.close()
        except RecordingError as error:
            self._stop(t_ns, str(error))
            self._abandon()

    def _flush_if_due(self) -> None:
        """The writer flushes by the messages' time, which may stand still; this is by the clock."""
        now_s = time.monotonic()
        if self._unflushed_since_s is None:
            self._unflushed_since_s = now_s
        elif now_s - self._unflushed_since_s >= self._flush_s:
            self._writer.flush()
            self._unflushed_since_s = None

    def _next(self) -> tuple[bool, int, Callable[[], None]] | None:
        """The next write; a flush when nothing has come for a while; None at the end."""
        with self._changed:
            while not self._work and not self._closing:
                quiet = not self._changed.wait(None if self._unflushed_since_s is None else self._flush_s)
                if quiet and self._unflushed_since_s is not None and not self._work:
                    self._unflushed_since_s = None
                    return False, 0, self._writer.flush
            return self._work.popleft() if self._work and self._error is None else None

    def _stop(self, t_ns: int, why: str) -> None:
        with self._changed:
            if self._error is not None:
                return
            self._error = why
            self._work.clear()
            self._frames_queued = 0
            self._changed.notify_all()
        self._tell(Event(t_ns, "recording", REASON_STOPPED, why))

    def _abandon(self) -> None:
        """Close the file after an error, with its index if the disk takes it."""
        try:
            self._writer.close()
        except RecordingError:
            # The same disk, reported already; the reader opens the file up to its last complete chunk.
            return
