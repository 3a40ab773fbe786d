"""The work behind ``teleop record``: a source through the whole pipeline into a recording that can be done again."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from robot_sim.world import World
from server.cli.record_live import Tell, live_moments
from server.engine.core import Core, Moment
from server.engine.ledger import Ledger
from server.engine.mailbox import Arrived
from server.engine.recording import SessionRecorder, describe
from server.settings import Settings
from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.errors import RecordingError
from teleop.frames import DepthFrame
from teleop.intent_types import Event, Mode
from teleop.sources.base import Source


@dataclass(frozen=True, slots=True)
class RecordOptions:
    """seconds: how long. color: whether colour is kept. engage: the operator is engaged as by the button."""

    seconds: float | None = None
    color: bool = True
    engage: bool = False


class _FrameClock:
    """A recorded source sets its own pace: the time is that of its frame."""

    def __init__(self, live: bool) -> None:
        self._live = live
        self._now_s = 0.0

    def __call__(self) -> float:
        return time.monotonic() if self._live else self._now_s

    def show(self, t_ns: int) -> None:
        self._now_s = t_ns * 1e-9


def record_session(
    source: Source,
    output: Path,
    settings: Settings,
    options: RecordOptions,
    on_frame: Callable[[DepthFrame], None] | None = None,
    tell: Tell = lambda _: None,
) -> int:
    """Track, interpret, decide, simulate and write until the source ends, the time is up or Ctrl-C.

    A recording's frames are all taken, at the pace of their stamps; a sensor's as they come. tell: one line when a
    sensor stalls. Returns the number of frames. Raises TeleopError; what was recorded until then is complete.
    """
    clock = _FrameClock(source.info.live)
    model = load_model(settings.model)
    tracker = BodyTracker(model, settings.teleop.body)
    tracker.warm_up(source.info.camera)
    world = World(settings.robot, settings.seed)
    recorder: SessionRecorder | None = None
    problems: list[Event] = []
    count = 0
    try:
        recorder = SessionRecorder(
            output,
            source.info,
            world.urdf,
            problems.append,
            describe(settings, model, world),
            lossless=not source.info.live,
            config=settings.recording.model_copy(update={"color": options.color and settings.recording.color}),
        )
        core = Core(tracker, world, settings, Ledger(2), clock)
        core.forget(reset_robot=True)
        if source.info.live:
            moments = live_moments(source, core, recorder, settings, options.seconds, tell)
        else:
            moments = _recorded_moments(source, core, recorder, clock, options.seconds)
        with closing(moments):
            for moment in moments:
                seen = moment.fresh and moment.output is not None and moment.output.intent.mode is Mode.SEEN
                core.pending.engage = options.engage and seen
                if not recorder.write(moment):
                    break
                if moment.fresh and moment.frame is not None:
                    count += 1
                    if on_frame is not None:
                        on_frame(moment.frame)
    finally:
        if recorder is not None:
            recorder.close()
        world.close()
    stopped = next((event for event in problems if event.reason == "recording.stopped"), None)
    if stopped is not None:
        raise RecordingError(stopped.detail)
    return count


def _recorded_moments(
    source: Source, core: Core, recorder: SessionRecorder, clock: _FrameClock, seconds: float | None
) -> Generator[Moment, None, None]:
    """A step for every frame, whatever time it takes."""
    first_ns: int | None = None
    for frame in source.frames():
        first_ns = frame.t_ns if first_ns is None else first_ns
        if seconds is not None and frame.t_ns - first_ns > seconds * 1e9:
            return
        clock.show(frame.t_ns)
        yield core.on_frame(Arrived(recorder.settle(frame), clock(), 0.0), False, 1.0)
