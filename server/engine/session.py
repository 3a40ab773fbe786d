"""One session: a source being read, its replay controls, perhaps its recording."""

from __future__ import annotations

import time
import uuid
from dataclasses import dataclass

from server.engine.mailbox import Mailbox
from server.engine.playback import Playback
from server.engine.reader import Reader
from server.engine.recording import SessionRecorder
from teleop.sources.base import Source, SourceInfo


@dataclass(eq=False)
class Session:
    """Made by :func:`open_session`. started, ended: Unix time [s]. name: what the client asked for."""

    id: str
    name: str
    source: Source
    info: SourceInfo
    playback: Playback
    reader: Reader
    started: float
    ended: float | None = None
    recorder: SessionRecorder | None = None
    recording_now: bool = False

    @property
    def recording(self) -> str | None:
        """Name of the recording that is or was made."""
        return self.recorder.name if self.recorder else None

    @property
    def fault(self) -> str | None:
        """Why the source gives no more frames."""
        return self.reader.fault

    @property
    def speed(self) -> float:
        """How fast the robot's time runs: the replay's speed, 1 while it stands or is live."""
        state = self.playback.state
        return 1.0 if self.info.live or state.paused or state.ended else state.speed

    def close(self) -> None:
        """Stop reading, free the source, complete the recording; safe to call twice."""
        self.reader.stop()
        if self.recorder is not None:
            self.recorder.close()
        if self.ended is None:
            self.ended = time.time()


def new_session(
    name: str, source: Source, loop: bool, mailbox: Mailbox, recorder: SessionRecorder | None = None
) -> Session:
    """A session over an open source; nothing is read until its reader is started."""
    playback = Playback(loop, source.info.duration_s)
    reader = Reader(source, playback, mailbox, recorder)
    return Session(
        uuid.uuid4().hex[:12],
        name,
        source,
        source.info,
        playback,
        reader,
        started=time.time(),
        recorder=recorder,
        recording_now=recorder is not None,
    )
