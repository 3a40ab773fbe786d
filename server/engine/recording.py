"""A session's recording: every moment's frame, answers, events and inputs, written off the engine's thread."""

from __future__ import annotations

import json
import math
from collections import OrderedDict
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from robot_sim.link.robot_link import RobotLink
from robot_sim.state import RobotState
from server.engine.core import Moment
from server.settings import Settings
from teleop.body.model import BodyModel
from teleop.config.recording import RecordingConfig
from teleop.frames import DepthFrame
from teleop.intent_types import Event
from teleop.recording import topics
from teleop.recording.identity import identity
from teleop.recording.inputs_json import inputs_to_json
from teleop.recording.recorder import AsyncRecorder, RecorderStatus
from teleop.recording.writer import McapWriter
from teleop.sources.base import SourceInfo
from teleop.sources.jpeg import through_jpeg
from teleop.track_row import command_row, track_row


def describe(settings: Settings, model: BodyModel, world: RobotLink) -> dict[str, str]:
    """What decided the session beside frames and inputs, for the recording's metadata."""
    made_with = session_identity(model)
    del made_with[topics.KEY_SOFTWARE]  # the writer's own
    return made_with | {
        topics.KEY_SETTINGS: json.dumps(settings_json(settings) | {"robot": world.config.model_dump(mode="json")}),
        topics.KEY_SEED: str(world.seed),
    }


def session_identity(model: BodyModel) -> dict[str, str]:
    """What the bits of a session of this engine depend on beside its settings and inputs."""
    return identity(model, "server.engine")


def settings_json(settings: Settings) -> dict[str, Any]:
    """The part of the settings that decides what the robot does."""
    return settings.model_dump(mode="json", include={"engine", "teleop"})


JITTER_S = 0.05
"""Frames come no more than this much sooner or later than their stamps say."""
_REMEMBERED = 300
"""Live frames whose fate is remembered until the engine has taken them; the mailbox holds one."""


class SessionRecorder:
    """Opens the file at once, so that a wrong folder is known before the session starts. Raises RecordingError.

    A recorded source's frames are written with their step, and ``lossless`` waits for the disk instead of dropping
    any; a live one's by who receives them, so that none is missing which the engine had no time for.
    """

    def __init__(
        self,
        path: Path,
        info: SourceInfo,
        urdf: str,
        on_event: Callable[[Event], None],
        description: Mapping[str, str],
        lossless: bool = False,
        config: RecordingConfig | None = None,
    ) -> None:
        self._config = config or RecordingConfig()
        writer = McapWriter(
            path,
            info.camera,
            source_uri=info.uri,
            urdf=urdf,
            color=info.has_color,
            metadata=description,
            config=self._config,
        )
        self._recorder = AsyncRecorder(
            writer,
            capacity=self._config.queue_frames,
            on_event=on_event,
            lossless=lossless,
            flush_s=self._config.flush_s,
        )
        self._live = info.live
        self._stored: OrderedDict[int, bool] = OrderedDict()
        self._last_ns: int | None = None
        self._frame_s = 0.0
        self._waiting: dict[str, Any] | None = None
        self._audits: list[tuple[str, str]] = []
        self._closed = False
        self.name = path.stem

    @property
    def error(self) -> str | None:
        """Why nothing more is written."""
        return self._recorder.status.error

    @property
    def status(self) -> RecorderStatus:
        """Counts of what was written and dropped."""
        return self._recorder.status

    @property
    def thread_id(self) -> int | None:
        """The system's number of the writing thread."""
        return self._recorder.thread_id

    def settle(self, frame: DepthFrame) -> DepthFrame:
        """The frame as the recording gives it back, so that what is computed from it can be computed again."""
        return through_jpeg(frame, self._config.jpeg_quality) if self._config.color else frame.without_color()

    def receive(self, frame: DepthFrame) -> None:
        """Record a live frame at once; called by the thread that reads the source."""
        if self._closed:
            return
        self._stored[frame.t_ns] = self._recorder.write_frame(frame)
        while len(self._stored) > _REMEMBERED:
            self._stored.popitem(last=False)

    def note(self, kind: str, reason: str, detail: str) -> None:
        """Record an event of the server's own; before the first frame there is nothing to record it with."""
        if not self._closed and self._last_ns is not None:
            self._recorder.write_event(Event(self._last_ns, kind, reason, detail))

    def write(self, moment: Moment) -> bool:
        """Record one step. False when the recording is over: its source began again, or the disk gave up."""
        if self._closed:
            return False
        frame, output = moment.frame, moment.output
        stored = False
        later = self._last_ns is None or (frame is not None and frame.t_ns > self._last_ns)
        if moment.fresh and not later and output is not None and output.accepted:
            self.close()  # a recording knows one run of time; a loop or a jump back is another one
            return False
        if moment.fresh and later and frame is not None and output is not None:
            t_ns = self._last_ns = frame.t_ns
            self._write_waiting(t_ns)
            self._write_audits(t_ns)
            stored = self._stored.get(t_ns, False) if self._live else self._recorder.write_frame(frame)
            self._recorder.write_skeleton(t_ns, output.track.skeleton)
            self._recorder.write_row(t_ns, track_row(output.track, output.intent, moment.command))
            self._recorder.write_robot(t_ns, moment.robot)
        if self._last_ns is None:
            return True  # nothing before the first frame counts: the robot begins from its start there
        if stored or moment.fresh:
            self._frame_s = moment.told.now_s
        elif (silent_s := moment.told.now_s - self._frame_s - JITTER_S) > 0.0:
            # frames have clocks of their own: as long after the last one, but surely before the next
            self._recorder.write_robot(self._last_ns + round(silent_s * 1e9), moment.robot)
        for event in moment.events:
            self._recorder.write_event(event)
        self._recorder.write_input(self._last_ns, inputs_row(moment, stored))
        return self._recorder.status.error is None

    def write_settings(self, settings: Settings) -> None:
        """Record that these settings are in force from the next step on."""
        self._waiting = {"settings": settings_json(settings)}
        if self._last_ns is not None:
            self._write_waiting(self._last_ns)

    def audit(self, action: str, detail: str) -> None:
        """Record who did what; what comes before the first frame waits for it."""
        if not self._closed:
            self._audits.append((action, detail))
            if self._last_ns is not None:
                self._write_audits(self._last_ns)

    def close(self) -> None:
        """Write what is queued and close the file; safe to call twice."""
        if not self._closed:
            self._closed = True
            self._recorder.close()

    def _write_audits(self, t_ns: int) -> None:
        for action, detail in self._audits:
            self._recorder.write_event(Event(t_ns, "audit", f"audit.{action}", detail))
        self._audits.clear()

    def _write_waiting(self, t_ns: int) -> None:
        if self._waiting is not None:
            self._recorder.write_input(t_ns, self._waiting)
            self._waiting = None


def step_answer(moment: Moment) -> dict[str, Any]:
    """What a step came to: command, reasons, robot; as a replay compares it."""
    return {"command": command_row(moment.command), "reasons": list(moment.command.reasons)} | robot_row(moment.robot)


def robot_row(robot: RobotState) -> dict[str, Any]:
    """Joints [rad or m] and chassis: x, y [m], sine and cosine of half the yaw."""
    half = 0.5 * robot.base_yaw_rad
    base = {"x": robot.base_x_m, "y": robot.base_y_m, "qz": math.sin(half), "qw": math.cos(half)}
    return {"robot": {name: float(q) for name, q in robot.joint_rad.items()}, "base": base}


def inputs_row(moment: Moment, stored: bool) -> dict[str, Any]:
    """All that replay needs beside the frames. ``sim_time_s`` counts the physics ticks.

    frame: the step had one. stored: the recording holds it; one whose stamp was refused is known by its stamp alone.
    between: what came of a step that has no row of its own.
    """
    told = moment.told
    between = {} if stored else {"between": step_answer(moment)}
    return (
        inputs_to_json(moment.inputs)
        | between
        | {
            "frame": moment.fresh,
            "stored": stored,
            "frame_t_ns": moment.frame.t_ns if moment.fresh and moment.frame is not None else None,
            "received_s": moment.received_s,
            "now_s": told.now_s,
            "live": told.live,
            "speed": told.speed,
            "latched": told.estop,
            "watchdog": [event.reason for event in moment.events if event.kind == "watchdog"],
            "sim_time_s": moment.robot.sim_time_s,
        }
    )
