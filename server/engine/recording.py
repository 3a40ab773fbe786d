"""A session's recording: every moment's frame, answers, events and inputs, written off the engine's thread."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from server.engine.core import Moment
from teleop.intent_types import Event
from teleop.recording.recorder import AsyncRecorder
from teleop.recording.writer import McapWriter
from teleop.sources.base import SourceInfo
from teleop.track_row import track_row


class SessionRecorder:
    """Opens the file at once, so that a wrong folder is known before the session starts. Raises RecordingError."""

    def __init__(self, path: Path, info: SourceInfo, urdf: str, on_event: Callable[[Event], None]) -> None:
        writer = McapWriter(path, info.camera, source_uri=info.uri, urdf=urdf, color=info.has_color)
        self._recorder = AsyncRecorder(writer, on_event=on_event)
        self._last_ns: int | None = None
        self._closed = False
        self.name = path.stem

    def write(self, moment: Moment) -> bool:
        """Record one step. False when the recording is over: its source began again, or the disk gave up."""
        frame, output = moment.frame, moment.output
        if self._closed or frame is None or output is None:
            return not self._closed
        if moment.fresh and self._last_ns is not None and frame.t_ns <= self._last_ns:
            self.close()  # a recording knows one run of time; a loop or a jump back is another one
            return False
        t_ns = frame.t_ns
        if moment.fresh:
            self._last_ns = t_ns
            self._recorder.write_frame(frame)
            self._recorder.write_skeleton(t_ns, output.track.skeleton)
            self._recorder.write_row(t_ns, track_row(output.track, output.intent, moment.command))
            self._recorder.write_robot(t_ns, moment.robot)
        for event in moment.events:
            self._recorder.write_event(event)
        self._recorder.write_input(t_ns, _inputs_row(moment))
        return self._recorder.status.error is None

    def close(self) -> None:
        """Write what is queued and close the file; safe to call twice."""
        if not self._closed:
            self._closed = True
            self._recorder.close()


def _inputs_row(moment: Moment) -> dict[str, Any]:
    """All that replay needs beside the frames. ``sim_time_s`` counts the physics ticks."""
    inputs = moment.inputs
    return {
        "engage": inputs.engage,
        "disengage": inputs.disengage,
        "estop": inputs.estop,
        "estop_reset": inputs.estop_reset,
        "request": None if inputs.request is None else asdict(inputs.request),
        "receive_t_ns": inputs.receive_t_ns,
        "source_failed": inputs.source_failed,
        "frame": moment.fresh,
        "watchdog": [event.reason for event in moment.events if event.kind == "watchdog"],
        "sim_time_s": moment.robot.sim_time_s,
    }
