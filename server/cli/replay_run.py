"""A recorded session done again: its frames and inputs through tracking, mapping, safety and simulation."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from robot_sim.world import World
from server.engine.core import Core, Moment
from server.engine.ledger import Ledger
from server.engine.mailbox import Arrived
from server.engine.pending import Pending
from server.engine.recording import robot_row, session_identity, step_answer
from server.settings import Settings, changed
from teleop.body.model import BodyModel
from teleop.body.tracker import BodyTracker
from teleop.errors import RecordingError
from teleop.frames import DepthFrame
from teleop.inputs import RobotRequest
from teleop.recording import McapSource, topics
from teleop.recording.comparison import NOTICEABLE, Comparison
from teleop.recording.inputs_json import inputs_from_json
from teleop.recording.recorded import RecordedAnswers, RecordedFrames
from teleop.track_row import track_row


class RecordedClock:
    """Shows the time of the recorded step."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> float:
        """The recorded monotonic time [s]."""
        return self.now_s


def recorded_settings(source: McapSource) -> Settings:
    """The settings the session began with. Raises RecordingError when the recording does not say."""
    text = source.metadata.get(topics.KEY_SETTINGS)
    if text is None:
        raise RecordingError(
            f"{source.path} does not say with which settings it was made, so it cannot be done again; "
            f"make a recording that does with 'teleop record {source.path} OUT.mcap'"
        )
    try:
        tree = json.loads(text)
    except ValueError as error:
        raise RecordingError(f"{source.path}: metadata '{topics.KEY_SETTINGS}' is damaged: {error}") from None
    return laid_over(Settings(), tree)


def laid_over(settings: Settings, tree: Any) -> Settings:
    """Settings with a recorded tree laid over them. Raises RecordingError and SettingsError."""
    if not isinstance(tree, dict):
        raise RecordingError(f"the recorded settings are damaged: expected a tree, got {str(tree)[:40]}")
    return changed(settings, tree)


def unlike(source: McapSource, model: BodyModel) -> list[str]:
    """What differs between the machine and software that recorded and those here; empty: every bit must agree."""
    here = session_identity(model)
    return [name for name, value in here.items() if source.metadata.get(name) != value]


def compare(
    source: McapSource,
    model: BodyModel,
    change: Mapping[str, Any] | None = None,
    on_frame: Callable[[DepthFrame], None] | None = None,
) -> Comparison:
    """Do the session again and hold it against what was recorded.

    change: settings laid over the recorded ones; those changed during the session are then left as they began.
    Raises RecordingError and SettingsError.
    """
    answers = RecordedAnswers(source)
    settings = recorded_settings(source)
    if change is not None:
        settings = changed(settings, change)
    found = Comparison(blind=None if change is None else NOTICEABLE)
    for moment, between in again(source, model, settings, follow_settings=change is None):
        frame, output = moment.frame, moment.output
        if between is not None:
            found.add_between(moment.command.t_ns, between, json.loads(json.dumps(step_answer(moment))))
            continue
        recorded = answers.at(frame.t_ns) if frame is not None else None
        if frame is None or output is None or recorded is None:
            found.missing += 1
            continue
        row = json.loads(json.dumps(track_row(output.track, output.intent, moment.command)))
        found.add(frame.t_ns, recorded, row | robot_row(moment.robot))
        if on_frame is not None:
            on_frame(frame)
    # frames that were dropped by the recorder
    found.missing += max(0, len(source.file.topics[topics.TRACK].t_ns) - found.frames - found.missing)
    return found


def again(
    source: McapSource, model: BodyModel, settings: Settings, *, follow_settings: bool
) -> Iterator[tuple[Moment, dict[str, Any] | None]]:
    """Every recorded step whose answer is known, done again; with that answer for a step without a frame of its own.

    Ends where the recording lacks a frame that was used. Recordings of older versions know no such answers.
    """
    clock = RecordedClock()
    world = World(settings.robot, _seed(source))
    try:
        tracker = BodyTracker(model, settings.teleop.body)
        tracker.warm_up(source.info.camera)
        core = Core(tracker, world, settings, Ledger(2), clock)
        core.forget(reset_robot=True)
        frames = RecordedFrames(source)
        last: DepthFrame | None = None
        for _, row in source.rows(topics.INPUTS):
            if "settings" in row:
                if follow_settings:
                    core.configure(laid_over(settings, row["settings"]))
                continue
            step = RecordedStep(row)
            frame = frames.at(step.frame_t_ns) if step.stored and step.frame_t_ns is not None else last
            if step.frame_t_ns is not None and frame is None:
                return
            last = frame
            moment = step.run(core, clock, frame)
            if step.stored or step.between is not None:
                yield moment, None if step.stored else step.between
    finally:
        world.close()


class RecordedStep:
    """One row of /teleop/inputs."""

    def __init__(self, row: Mapping[str, Any]) -> None:
        """Raises RecordingError when the row lacks something or holds another type."""
        self.inputs = inputs_from_json(row)
        try:
            self.now_s, self.speed = _finite(row["now_s"]), _finite(row["speed"])
            self.live, self.latched, self.stored = bool(row["live"]), bool(row["latched"]), bool(row["stored"])
            self.between = dict(row["between"]) if "between" in row else None
            self.frame_t_ns = None if not row["frame"] else int(row["frame_t_ns"])
            self.received_s = 0.0 if self.frame_t_ns is None else _finite(row["received_s"])
        except (KeyError, TypeError, ValueError) as error:
            raise RecordingError(f"a row of /teleop/inputs cannot be read: {error!r}") from None

    def run(self, core: Core, clock: RecordedClock, frame: DepthFrame | None) -> Moment:
        clock.now_s = self.now_s
        if self.latched != core.world.state().estop:
            (core.world.estop if self.latched else core.world.estop_reset)()
        inputs = self.inputs
        core.pending = Pending(
            inputs.engage,
            inputs.disengage,
            inputs.estop,
            inputs.estop_reset,
            inputs.request or RobotRequest(),
            speeds_until_s=math.inf,
            picks=inputs.picks,
        )
        if self.frame_t_ns is None or frame is None:
            return core.on_silence(inputs.source_failed, self.speed)
        # a frame whose stamp was refused is known by its stamp alone; its picture was not looked at
        frame = replace(frame, t_ns=self.frame_t_ns)
        return core.on_frame(Arrived(frame, self.received_s, 0.0), self.live, self.speed)


def _finite(value: Any) -> float:
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"expected a number, got {value}")
    return number


def _seed(source: McapSource) -> int:
    text = source.metadata.get(topics.KEY_SEED, "0")
    if not text.isdigit():
        raise RecordingError(f"{source.path}: metadata '{topics.KEY_SEED}' is damaged: {text}")
    return int(text)
