"""From moments to messages: state at a bounded rate, every event, pictures that somebody looks at."""

from __future__ import annotations

import threading
import time
from collections import OrderedDict, deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from robot_sim.pick.plan import PickPlan
from server import wire
from server.engine import snapshot
from server.engine.core import Moment
from server.engine.ledger import Ledger
from server.engine.preview import Previewer
from server.engine.session import Session
from server.engine.tasks import Tasks
from server.images_wire import ImageKind
from server.settings import StreamConfig
from server.stream.hub import Hub
from teleop.assist.step import AssistState
from teleop.intent_types import Event, Mode, Zone
from teleop.modes import IN_CONTROL

_REMEMBERED = 600
_COVERAGE_S = 0.5
_PICTURES = frozenset({ImageKind.DEPTH, ImageKind.COLOR, ImageKind.PARTS})


@dataclass(frozen=True, slots=True)
class _Sent:
    """When a state's frame was received, when its message was begun [s, monotonic], the filter's delay [s]."""

    received_s: float
    begun_s: float
    filter_s: float


class Publisher:
    """Called by the engine's thread; :meth:`painted` and :meth:`latest` by the server's."""

    def __init__(self, hub: Hub, ledger: Ledger, config: StreamConfig, tasks: Tasks) -> None:
        self._hub = hub
        self._tasks = tasks
        self._planned: PickPlan | None = None
        self._ledger = ledger
        self._config = config
        self._previewer = Previewer(config, hub.post_image)
        self._lock = threading.Lock()
        self._telling = threading.Lock()
        self._event_id = 0
        self._sent: OrderedDict[int, _Sent] = OrderedDict()
        self._arrivals: deque[float] = deque(maxlen=60)
        self._seq = 0
        self._state_s = self._fresh_s = self._image_s = 0.0
        self._coverage_s = 0.0
        self._estop = False
        self._wet: dict[str, tuple[float, float, float]] = {}
        self._current: Moment | None = None
        self.session: Session | None = None
        """What is playing now; set by the engine."""

    def start(self) -> None:
        """Begin encoding pictures."""
        self._previewer.start()

    def stop(self) -> None:
        """Stop encoding pictures."""
        self._previewer.stop()

    def publish(self, moment: Moment) -> None:
        """Hand everything new to the clients."""
        now_s = time.monotonic()
        if moment.fresh and moment.received_s is not None:
            self._arrivals.append(moment.received_s)
        for event in moment.events:
            self.event(event)
        self._preview(moment.assist)
        with self._lock:
            self._current = moment
        pressed = moment.robot.estop != self._estop
        # frames jitter: a state may come a little early rather than a whole frame late; ticks never displace a frame
        early = now_s - (self._fresh_s if moment.fresh else self._state_s) < 0.6 / self._config.state_hz
        if early and not pressed:  # that the robot is stopped, or free again, is told at once
            return
        self._estop = moment.robot.estop
        self._state_s = now_s
        self._fresh_s = now_s if moment.fresh else self._fresh_s
        self._seq += 1
        self._images(moment, now_s)
        if self._hub.count == 0:
            return
        if moment.fresh and moment.received_s is not None:
            filter_s = self._ledger.last_s("filter") if moment.output and moment.output.track.skeleton else 0.0
            with self._lock:
                self._sent[self._seq] = _Sent(moment.received_s, now_s, filter_s)
                while len(self._sent) > _REMEMBERED:
                    self._sent.popitem(last=False)
        text = self._state(moment).model_dump_json()
        self._ledger.add("encode", time.monotonic() - now_s)
        self._hub.post_state(text)

    def event(self, event: Event) -> None:
        """An event for everybody."""
        self.announce(str(event.kind), str(event.reason), event.detail)

    def announce(self, kind: str, reason: str, detail: str = "") -> None:
        """An event of the server's own, at this moment. May be called from any thread."""
        session = self.session
        replayed = session is not None and not session.info.live
        position_s = round(session.playback.state.position_s, 2) if session is not None and replayed else None
        with self._telling:  # ids reach the clients in their order
            self._event_id += 1
            message = wire.EventMessage(
                id=self._event_id,
                t=round(time.time(), 3),
                kind=kind,
                reason=reason,
                detail=detail,
                position_s=position_s,
            )
            self._hub.post_event(message.model_dump_json(), self._event_id)

    def coverage(self, ask: Callable[[], Mapping[str, tuple[float, float, float]]]) -> None:
        """Tell what of the crop is wet when it has changed; asks at most every half second."""
        now_s = time.monotonic()
        if now_s - self._coverage_s < _COVERAGE_S:
            return
        self._coverage_s = now_s
        wet = dict(ask())
        if wet == self._wet:
            return
        self._wet = wet
        self._hub.post_kept("coverage", wire.Coverage(wet=wet).model_dump_json())

    def _preview(self, assist: AssistState) -> None:
        """Tell where a pick will go when that has changed."""
        task = assist.active
        plan = None if task is None else task.plan
        if plan is self._planned:
            return
        self._planned = plan
        self._hub.post_kept("preview", snapshot.preview(task).model_dump_json())

    def painted(self, seq: int, paint_ms: float | None = None) -> None:
        """A client has painted the overlay of state ``seq``: one sample of the whole way, way back included."""
        with self._lock:
            sent = self._sent.pop(seq, None)
        if sent is None:
            return
        now_s = time.monotonic()
        self._ledger.add("total", now_s - sent.received_s)
        self._ledger.add("motion", now_s - sent.received_s + sent.filter_s)
        if paint_ms is not None:
            self._ledger.add("paint", paint_ms / 1e3)
            self._ledger.add("send", max(0.0, now_s - sent.begun_s - paint_ms / 1e3))

    def latest(self) -> wire.State | None:
        """The present state, or None before the first step."""
        with self._lock:
            current = self._current
        return self._state(current) if current else None

    def _images(self, moment: Moment, now_s: float) -> None:
        wanted = self._hub.wanted & _PICTURES
        if not (wanted and moment.fresh and moment.frame is not None):
            return
        if now_s - self._image_s >= 0.8 / self._config.image_hz:
            self._image_s = now_s
            parts = moment.output.track.parts if moment.output else None
            self._previewer.offer(moment.frame, parts, self._seq, wanted)

    def _state(self, moment: Moment) -> wire.State:
        output = moment.output
        intent = output.intent if output else None
        track = output.track if output else None
        skeleton = None
        if track is not None and moment.frame is not None:
            skeleton = snapshot.skeleton_state(track.skeleton, moment.frame.camera)
        mode = intent.mode if intent else (Mode.STOPPED if moment.robot.estop else Mode.NO_PERSON)
        spine = intent.spine_xz_m if intent else None
        return wire.State(
            seq=self._seq,
            t=round(time.time(), 3),
            source=self._source(self.session),
            skeleton=skeleton,
            spine_xz=(round(spine[0], 3), round(spine[1], 3)) if spine else None,
            floor=snapshot.floor_state(track.floor if track else None),
            zone=(intent.zone if intent else Zone.NONE).value,
            mode=mode.value,
            engaged=mode in IN_CONTROL,
            engage_progress=round(intent.engage_progress, 3) if intent else 0.0,
            angles=snapshot.angles_state(intent.angles) if intent else wire.AnglesState(),
            hands=snapshot.hands_state(intent.hands) if intent else wire.HandsState(),
            command=snapshot.command_state(moment.command),
            robot=snapshot.robot_state(moment.robot),
            ghost=snapshot.ghost_state(moment.recorded),
            task=self._tasks.current,
            aim=snapshot.aim_state(moment.assist.aim, moment.assist_config),
            reasons=snapshot.merged_reasons(moment.command.reasons, moment.robot.reasons),
            latency_ms=self._ledger.table(),
            clients=self._hub.count,
        )

    def _source(self, session: Session | None) -> wire.SourceState | None:
        if session is None:
            return None
        play = session.playback.state
        return wire.SourceState(
            uri=session.name,
            kind=session.info.kind,
            live=session.info.live,
            paused=play.paused,
            ended=play.ended,
            position_s=round(play.position_s, 3),
            duration_s=None if session.info.duration_s is None else round(session.info.duration_s, 3),
            speed=play.speed,
            loop=play.loop,
            fps=self._fps(),
            recording=session.recording_now,
            fault=session.fault,
        )

    def _fps(self) -> float:
        """Frames per second over the last two seconds of arrivals."""
        since = time.monotonic() - 2.0
        recent = [s for s in list(self._arrivals) if s >= since]
        span = recent[-1] - recent[0] if len(recent) > 1 else 0.0
        return round((len(recent) - 1) / span, 1) if span > 0 else 0.0
