"""The thread that reads a source: recordings at their own pace, live sensors as fast as they come."""

from __future__ import annotations

import threading
import time

from server.engine.mailbox import Arrived, Mailbox
from server.engine.playback import Playback, Turn
from teleop.errors import TeleopError
from teleop.frames import DepthFrame
from teleop.recording import McapSource
from teleop.recording.recorded import RecordedModes, RecordedRobot
from teleop.sources.base import Source
from teleop.sources.jpeg import through_jpeg

_TAKE_OVER_FRAMES = 10
"""After a jump into the middle of a recorded session: time for the tracker to find the operator again."""


class Reader(threading.Thread):
    """Owns the source from now on, and closes it."""

    def __init__(self, source: Source, playback: Playback, mailbox: Mailbox, recorded: bool = False) -> None:
        """recorded: frames are handed on as the recording will give them back."""
        super().__init__(name="source-reader", daemon=True)
        self._source = source
        self._playback = playback
        self._mailbox = mailbox
        self._settle = through_jpeg if recorded else _as_it_is
        self._stopping = threading.Event()
        self.fault: str | None = None
        """Why the source gives no more frames, in one line."""

    def stop(self, timeout_s: float = 3.0) -> None:
        """End the thread. A live source that blocks is closed under it after ``timeout_s``."""
        self._stopping.set()
        self._playback.stop()
        self._mailbox.wake()
        self.join(timeout_s)
        if self.is_alive():
            self._source.close()

    def run(self) -> None:
        """Read until stopped, or until a live source ends."""
        try:
            if self._source.info.live:
                self._live()
            else:
                self._recorded()
        except (TeleopError, OSError) as error:
            if not self._stopping.is_set():
                self.fault = str(error)
                self._mailbox.wake()
        finally:
            self._source.close()

    def _live(self) -> None:
        first_ns: int | None = None
        for frame in self._source.frames():
            if self._stopping.is_set():
                return
            first_ns = frame.t_ns if first_ns is None else first_ns
            self._mailbox.put(Arrived(self._settle(frame), time.monotonic(), (frame.t_ns - first_ns) * 1e-9))
        if not self._stopping.is_set():
            self.fault = "the source gives no more frames; check its cable, then open it again"

    def _recorded(self) -> None:
        first_ns: int | None = None
        turn = Turn.SEEK
        recording = self._source if isinstance(self._source, McapSource) else None
        robot = RecordedRobot(recording) if recording else None
        modes = RecordedModes(recording) if recording else None
        while turn is Turn.SEEK:
            start_s = self._playback.start_at()
            restarted = start_s == 0.0 and first_ns is not None
            turn = Turn.DELIVER
            take_over = _TAKE_OVER_FRAMES if start_s > 0.0 else 0
            for frame in self._source.frames(start_s):
                first_ns = frame.t_ns if first_ns is None else first_ns
                position_s = (frame.t_ns - first_ns) * 1e-9
                turn = self._playback.turn(position_s)
                if turn is not Turn.DELIVER:
                    break
                received_s = time.monotonic()
                pose = robot.at(frame.t_ns) if robot else None
                in_control = take_over > 0 and modes is not None and modes.in_control(frame.t_ns)
                take_over -= 1
                self._give(Arrived(self._settle(frame), received_s, position_s, restarted, pose, in_control))
                restarted = False
            else:
                if first_ns is None:
                    raise TeleopError(f"{self._source.info.uri} holds no depth frames; choose another recording")
                turn = self._playback.end()

    def _give(self, arrived: Arrived) -> None:
        """A stutter of the machine slips the replay instead of skipping frames, but for a replay that is to race."""
        if self._playback.state.speed > 1.0:
            self._mailbox.put(arrived)
        else:
            self._mailbox.hand_over(arrived, self._stopping.is_set)


def _as_it_is(frame: DepthFrame) -> DepthFrame:
    return frame
