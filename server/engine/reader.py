"""The thread that reads a source: recordings at their own pace, live sensors as fast as they come."""

from __future__ import annotations

import threading
import time

from server.engine.mailbox import Arrived, Mailbox
from server.engine.playback import Playback, Turn
from server.engine.recording import SessionRecorder
from teleop.errors import TeleopError
from teleop.frames import DepthFrame
from teleop.recording import McapSource
from teleop.recording.recorded import RecordedModes, RecordedRobot
from teleop.sources.base import Source
from teleop.sources.reconnect import Reconnecting
from teleop.sources.statistics import FrameStatistics

_TAKE_OVER_FRAMES = 10
"""After a jump into the middle of a recorded session: time for the tracker to find the operator again."""


class Reader(threading.Thread):
    """Owns the source from now on, and closes it."""

    def __init__(
        self, source: Source, playback: Playback, mailbox: Mailbox, recorder: SessionRecorder | None = None
    ) -> None:
        """recorder: frames are handed on as the recording will give them back, and live ones recorded here.

        So a sensor's frame that the engine has no time for is in the recording all the same.
        """
        super().__init__(name="source-reader", daemon=True)
        self._source = source
        self._playback = playback
        self._mailbox = mailbox
        self._recorder = recorder
        self._stopping = threading.Event()
        self._ended: str | None = None
        self.statistics = FrameStatistics()
        if isinstance(source, Reconnecting):
            source.on_change = self._changed

    @property
    def fault(self) -> str | None:
        """Why the source gives no frames just now, or no more, in one line."""
        away = self._source.fault if isinstance(self._source, Reconnecting) else None
        return self._ended or away

    @property
    def comes_back(self) -> bool:
        """Whether the fault ends by itself when the sensor is there again."""
        return self._ended is None

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
                self._ended = str(error)
                self._mailbox.wake()
        finally:
            self._source.close()

    def _live(self) -> None:
        first_ns: int | None = None
        for frame in self._source.frames():
            if self._stopping.is_set():
                return
            received_s = time.monotonic()
            self.statistics.add(frame, received_s)
            first_ns = frame.t_ns if first_ns is None else first_ns
            settled = self._settle(frame)
            if self._recorder is not None:
                self._recorder.receive(settled)
            self._mailbox.put(Arrived(settled, received_s, (frame.t_ns - first_ns) * 1e-9))
        if not self._stopping.is_set():
            self._ended = "the source gives no more frames; check its cable, then open it again"
            self._mailbox.wake()

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

    def _settle(self, frame: DepthFrame) -> DepthFrame:
        return frame if self._recorder is None else self._recorder.settle(frame)

    def _changed(self) -> None:
        if self.fault is not None:
            self.statistics.interrupted()
        self._mailbox.wake()
