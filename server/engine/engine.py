"""The engine's thread: takes frames and requests as they come, steps the core, publishes what happened."""

from __future__ import annotations

import gc
import math
import threading
import time
import uuid
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Literal, TypeVar

from robot_sim.commands import stop_command
from robot_sim.link.robot_link import RobotLink
from robot_sim.metrics import RunMetrics
from robot_sim.pick.plan import warm_up
from robot_sim.scenario import load_scenario
from server import wire
from server.engine.core import Core, Moment
from server.engine.hello import hello
from server.engine.ledger import Ledger
from server.engine.mailbox import Arrived, Mailbox
from server.engine.preview import encoded
from server.engine.publisher import Publisher
from server.engine.recording import SessionRecorder, describe
from server.engine.session import Session, new_session
from server.engine.tasks import Tasks
from server.engine.ticks import Ticks
from server.errors import Refused
from server.images_wire import ImageKind
from server.settings import Settings
from server.stream.hub import Hub
from teleop.body.tracker import BodyTracker
from teleop.errors import TeleopError
from teleop.frames import Camera
from teleop.inputs import PickAsk, RobotRequest
from teleop.reasons import Reason
from teleop.sources.base import Source

T = TypeVar("T")
_KEPT_SESSIONS = 50
CALL_TIMEOUT_S = 10.0
"""Longest wait for the engine between two steps; only a dead engine needs more."""


class Engine(threading.Thread):
    """Everything that moves. Its methods may be called from any thread; the work happens in this one."""

    def __init__(self, settings: Settings, tracker: BodyTracker, world: RobotLink, hub: Hub) -> None:
        super().__init__(name="engine", daemon=True)
        self.boot = uuid.uuid4().hex[:12]
        """Differs from one start of the server to the next."""
        self.ledger = Ledger(settings.engine.ledger_frames)
        self.tasks = Tasks(world.fruits)
        self.publisher = Publisher(hub, self.ledger, settings.stream, self.tasks)
        self._settings = settings
        self._hub = hub
        self._tracker = tracker
        self._core = Core(tracker, world, settings, self.ledger)
        self._scenery = world.scenery()
        self.scenario = load_scenario(settings.scenario) if settings.scenario else None
        """The run that is played, if it is one with a goal."""
        self.fruits = world.fruits
        """All fruit as it grew."""
        warm_up(world.config)
        self._urdf = world.urdf
        self._mailbox = Mailbox()
        self._calls: deque[Callable[[], None]] = deque()
        self._decided: list[Future[None]] = []
        self._session: Session | None = None
        self._sessions: deque[Session] = deque(maxlen=_KEPT_SESSIONS)
        self._switching = threading.Lock()
        self._stopping = False
        self._spared = False
        self._pressed = False
        self._hurry = threading.Event()
        self._core.look_up = self._stop_in_a_hurry
        self._opened_by = (-math.inf, "")
        self._head_s = 0.0
        self._reported: str | None = None
        self.on_moment: Callable[[Moment], None] | None = None
        """Who else is told of every step; must return at once."""
        self.frames = 0
        self._stepped_s = time.monotonic()

    @property
    def settings(self) -> Settings:
        """The settings now in force."""
        return self._settings

    @property
    def urdf(self) -> str:
        """The robot's URDF text."""
        return self._urdf

    @property
    def session(self) -> Session | None:
        """The session that is running."""
        return self._session

    @property
    def sessions(self) -> tuple[Session, ...]:
        """Running and finished sessions, oldest first."""
        return tuple(self._sessions)

    @property
    def step_age_s(self) -> float:
        """Time since the last step; a running engine steps at ``engine.tick_hz`` at least."""
        return time.monotonic() - self._stepped_s

    @property
    def dropped(self) -> int:
        """Frames of a live source, or of a racing replay, that a newer one replaced before the engine took them."""
        return self._mailbox.dropped

    def hello(self) -> wire.Hello:
        """The first message for a client."""
        session = self._session
        camera = session.info.camera if session else Camera()
        return hello(self._settings, camera, self._scenery, self.fruits).model_copy(update={"boot": self.boot})

    def call(self, work: Callable[[], T]) -> Future[T]:
        """Run something between two steps, on this thread, as soon as possible."""
        future: Future[T] = Future()

        def run() -> None:
            if not future.set_running_or_notify_cancel():
                return
            try:
                future.set_result(work())
            except BaseException as error:
                future.set_exception(error)
                if not isinstance(error, Exception):
                    raise

        if self._stopping:
            raise Refused(503, "the server is shutting down")
        self._calls.append(run)
        self._mailbox.wake()
        return future

    def open(self, name: str, source: Source, loop: bool, record_to: Path | None = None) -> Session:
        """Switch to an open source; the one before is closed. Blocks until it is done.

        record_to: a file to be written. Raises RecordingError when it cannot be; the session before goes on then.
        """
        with self._switching:
            try:
                recorder = None
                if record_to is not None:
                    told = describe(self._settings, self._tracker.model, self._core.world)
                    recorder = SessionRecorder(
                        record_to,
                        source.info,
                        self._urdf,
                        self.publisher.event,
                        told,
                        config=self._settings.recording,
                    )
                self._tracker.warm_up(source.info.camera)
                self._spare_the_collector()
            except TeleopError:
                source.close()
                raise
            session = new_session(name, source, loop, self._mailbox, recorder)
            self._close_session()
            self.call(lambda: self._begin(session)).result(CALL_TIMEOUT_S)
            session.reader.start()
        return session

    def _spare_the_collector(self) -> None:
        """Once, when all is compiled: what that left in memory stays, so the garbage collector need not walk it.

        After a first start it took 0.4 s each time, in which nothing steps and the robot holds.
        """
        if not self._spared:
            gc.collect()
            gc.freeze()
            self._spared = True

    def close_session(self, session_id: str) -> None:
        """End the running session of that id; a finished one stays as it is."""
        with self._switching:
            if self._session is not None and self._session.id == session_id:
                self._close_session()

    def configure(self, change: Callable[[Settings], Settings]) -> Future[Settings]:
        """Change the settings that are in force then, and give the new ones; perception and intent begin anew.

        The change is made between two steps, so that of two at once neither is lost. What it raises is the future's.
        """

        def work() -> Settings:
            settings = change(self._settings)
            if settings == self._settings:
                return settings
            self._core.configure(settings)
            self._settings = settings
            session = self._session
            if session is not None and session.recorder is not None:
                session.recorder.write_settings(settings)
            self._say_hello()
            self.publisher.announce("config", "config.changed")
            return settings

        return self.call(work)

    def engage(self, on: bool) -> Future[None]:
        """Engage or disengage the operator, as if by gesture."""

        def work() -> None:
            self._core.pending.engage = on
            self._core.pending.disengage = not on

        return self.call(work)

    def estop(self, on: bool) -> Future[None]:
        """Latch the emergency stop, or release it. A stop is followed at once: it waits for no frame and no tick.

        The robot stops in the middle of the step that is under way; that it is stopped is told in order.
        """
        if on:
            self._hurry.set()

        def work() -> None:
            (self._core.estop if on else self._core.estop_reset)()
            self._pressed |= on
            if on:
                self._hurry.clear()

        return self.call(work)

    def _stop_in_a_hurry(self) -> None:
        if self._hurry.is_set():
            self._hurry.clear()
            self._core.estop()

    def ask(self, request: RobotRequest, for_s: float) -> Future[None]:
        """Direct control; speeds are repeated for ``for_s`` seconds."""
        return self.call(lambda: self._core.pending.ask(request, time.monotonic() + for_s))

    def pick(self, fruit: str | None, preview: bool) -> Future[tuple[wire.TaskState, bool]]:
        """Begin an assisted pick: the task after the step that took it, and whether it is a new one.

        While one for the same fruit (or, when none is named, for any) is under way, that one is given.
        """
        told: Future[tuple[wire.TaskState, bool]] = Future()

        def work() -> None:
            known = self.tasks.active(fruit)
            if known is not None:
                told.set_result((known, False))
                return
            ask = PickAsk(uuid.uuid4().hex[:12], fruit=fruit, preview=preview)
            self.tasks.expect(ask.id).add_done_callback(lambda taken: told.set_result((taken.result(), True)))
            self._core.pending.picks += (ask,)

        self.call(work)
        return told

    def decide_pick(self, task_id: str, action: Literal["confirm", "cancel"]) -> Future[None]:
        """Confirm a preview, or end a task that is under way; others are left as they are. Done after that step."""
        told: Future[None] = Future()

        def work() -> None:
            self._core.pending.picks += (PickAsk(task_id, action),)
            self._decided.append(told)

        self.call(work)
        return told

    def end_picks(self, reason: Reason) -> None:
        """End the task under way, if there is one: who asked for it is gone."""

        def work() -> None:
            task = self._core.assist.active
            if task is not None and not task.attended:
                self._core.pending.picks += (PickAsk(task.id, "cancel", reason=reason),)

        self.call(work)

    def metrics(self) -> Future[RunMetrics]:
        """What the run has come to."""
        return self.call(lambda: self._core.world.metrics())

    def goal_coverage(self) -> Future[float]:
        """Wet share 0..1 of the leaves in the window of the scenario's goal; 0 without one."""
        return self.call(lambda: 0.0 if self.scenario is None else self.scenario.goal.wet(self._core.world.coverage))

    def restart_robot(self) -> Future[RunMetrics]:
        """The robot back to its start. The future raises Refused (409) while a recording is made."""

        def work() -> RunMetrics:
            if self._session is not None and self._session.recording_now:
                raise Refused(409, "a recording is being made; end its session first, or record a new one from a reset")
            self._core.restart_robot()
            return self._core.world.metrics()

        return self.call(work)

    def head_jpeg(self) -> Future[bytes]:
        """A picture of the head camera."""
        return self.call(lambda: self._head_picture(0))

    def audit(self, action: str, detail: str) -> None:
        """Tell the recording that is being made who did what. Does nothing while the server shuts down."""

        def work() -> None:
            if action == "sessions":
                self._opened_by = (time.monotonic(), detail)
            session = self._session
            if session is not None and session.recorder is not None:
                session.recorder.audit(action, detail)

        if not self._stopping:
            self.call(work)

    def stop(self) -> None:
        """Stop the robot, close source and recording, end the thread."""
        with self._switching:
            if self.is_alive():
                self._close_session()
            self._stopping = True
            self._mailbox.wake()
        if self.is_alive():
            self.join(5.0)

    def run(self) -> None:
        """Step until stopped."""
        self.publisher.start()
        ticks = Ticks(self._settings.engine.tick_hz)
        try:
            while not self._stopping:
                arrived = self._mailbox.take(ticks.due_s - time.monotonic())
                while self._calls:
                    self._calls.popleft()()
                if self._pressed:
                    self._pressed = False
                    self._publish(self._on_silence())  # the robot brakes before the next picture is looked at
                if arrived is not None:
                    self._publish(self._on_frame(arrived))
                    ticks.frame(arrived.received_s, time.monotonic())
                elif time.monotonic() >= ticks.due_s:
                    self._publish(self._on_silence())
                    ticks.tick(time.monotonic())
        finally:
            self._stopping = True
            self._core.world.step(stop_command(0), 0.5)
            self._core.world.close()
            self.publisher.stop()

    def _on_frame(self, arrived: Arrived) -> Moment:
        session = self._session
        self.frames += 1
        self._tell_fault(session)
        return self._core.on_frame(
            arrived, live=session is None or session.info.live, speed=session.speed if session else 1.0
        )

    def _on_silence(self) -> Moment:
        session = self._session
        fault = self._tell_fault(session)
        return self._core.on_silence(source_failed=fault is not None, speed=session.speed if session else 1.0)

    def _tell_fault(self, session: Session | None) -> str | None:
        """Why the source gives no frames, told once when it begins and once when it ends."""
        fault = session.fault if session else None
        if session is None or fault == self._reported:
            return fault
        self._reported = fault
        reason = "source.camera_back" if fault is None else "stop.source_failed"
        if fault is not None and session.info.live:
            reason = "source.camera_lost"
        self.publisher.announce("source", reason, fault or session.name)
        if session.recorder is not None:
            session.recorder.note("source", reason, fault or session.name)
        return fault

    def _publish(self, moment: Moment) -> None:
        session = self._session
        self._stepped_s = time.monotonic()
        self.tasks.observe(moment.assist)
        if not self._core.pending.picks:
            decided, self._decided = self._decided, []
            for told in decided:
                told.set_result(None)
        self.publisher.publish(moment)
        if self.on_moment is not None:
            self.on_moment(moment)
        if self._hub.count:
            self.publisher.coverage(self._core.world.wet_leaves)
        if session is not None and session.recorder is not None and session.recording_now:
            session.recording_now = session.recorder.write(moment)
            if not session.recording_now and session.recorder.status.error is None:
                self.publisher.announce("recording", "recording.completed", session.recorder.name)
        now_s = time.monotonic()
        if ImageKind.HEAD in self._hub.wanted and now_s - self._head_s >= 1.0 / self._settings.stream.head_hz:
            self._head_s = now_s
            self._head_picture(1)

    def _head_picture(self, post: int) -> bytes:
        config = self._settings.stream
        width, height = config.head_width_px, config.head_width_px * 3 // 4
        rgb = self._core.world.head_camera_rgb(width, height)
        packet = encoded(ImageKind.HEAD, rgb[:, :, ::-1], 0, config.jpeg_quality)
        if post:
            self._hub.post_image(packet)
        return packet.jpeg

    def _begin(self, session: Session) -> None:
        self._mailbox.clear()
        self._core.forget(reset_robot=session.recorder is not None)
        self.ledger.clear()
        self._reported = None
        self._session = self.publisher.session = session
        self._sessions.append(session)
        at_s, who = self._opened_by
        if session.recorder is not None and time.monotonic() - at_s < CALL_TIMEOUT_S:
            session.recorder.audit("sessions", who)
        self._say_hello()
        self.publisher.announce("source", "source.opened", session.name)

    def _close_session(self) -> None:
        session = self._session
        if session is None:
            return
        session.close()

        def work() -> None:
            self._mailbox.clear()
            self._core.forget()
            self._session = self.publisher.session = None
            self.publisher.announce("source", "source.closed", session.name)

        self.call(work).result(CALL_TIMEOUT_S)

    def _say_hello(self) -> None:
        self._hub.post_event(self.hello().model_dump_json())
