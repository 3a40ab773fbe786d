"""From a track to what the operator wants: sight, zone, hands, gestures, control, task, mode; one frame at a time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from teleop.angles import NO_ANGLES, body_angles, leg_angles
from teleop.config.intent import HandConfig, IntentConfig
from teleop.control import Control, Seen, step_control
from teleop.engage import Gestures, GestureState, engage_pose, forearms_crossed, step_gestures
from teleop.frames import DepthFrame
from teleop.hands.debounce import HandMemory, step_hand
from teleop.hands.reader import read_hands
from teleop.hands.skin_model import SkinModel, step_skin
from teleop.inputs import Inputs
from teleop.intent_types import BodyAngles, Event, Hands, Intent, Mode, Zone
from teleop.joints import JOINT_INDEX
from teleop.modes import Conditions, next_mode
from teleop.reasons import Reason
from teleop.sight import Sight, step_sight
from teleop.skeleton import Skeleton, Track
from teleop.stillness import Gait, step_gait
from teleop.task import TaskState, step_task
from teleop.zones import ZoneState, step_zone

HandReader = Callable[[DepthFrame, Skeleton | None, HandConfig, SkinModel | None], Hands]
"""What both hands show in one frame; the skeleton in camera axes, the skin as remembered so far."""
LEGS = [JOINT_INDEX[name] for name in ("hip_right", "knee_right", "hip_left", "knee_left")]


@dataclass(frozen=True, slots=True, eq=False)
class IntentState:
    """Memory between frames, one part per question.

    shown_zone: the zone the last frame was said to lie in. leaving: the operator was last seen outside all zones.
    """

    mode: Mode = Mode.NO_PERSON
    control: Control = field(default_factory=Control)
    sight: Sight = field(default_factory=Sight)
    zone: ZoneState = field(default_factory=ZoneState)
    task: TaskState = field(default_factory=TaskState)
    gestures: GestureState = field(default_factory=GestureState)
    right_hand: HandMemory = field(default_factory=HandMemory)
    left_hand: HandMemory = field(default_factory=HandMemory)
    skin: SkinModel | None = None
    gait: Gait = field(default_factory=Gait)
    progress: float = 0.0
    shown_zone: Zone = Zone.NONE
    leaving: bool = False


@dataclass(frozen=True, slots=True)
class Circumstances:
    """What the frame checks say. used: the frame brings something new; dt_s: time since the last used one."""

    t_ns: int
    dt_s: float
    used: bool
    restarted: bool
    reasons: tuple[Reason, ...] = ()


def settled_hands(state: IntentState) -> Hands:
    """Both hands after debouncing."""
    right, left = state.right_hand, state.left_hand
    return Hands(right.settled, left.settled, right.confidence, left.confidence)


def spine_xz_m(body: Skeleton | None) -> tuple[float, float] | None:
    """a = [x, z] of the spine (4), levelled, in metres."""
    spine = None if body is None else body.joint("spine")
    return None if spine is None else (float(spine[0]), float(spine[2]))


def _zone(state: IntentState, sight: Sight, body: Skeleton | None, dt_s: float, config: IntentConfig) -> ZoneState:
    """The zone of this frame: the last one while tracking fails for a moment, none once the operator has left."""
    if body is not None:
        return step_zone(state.zone, spine_xz_m(body), dt_s, config.zones)
    if sight.body is None or state.leaving or sight.lost_s > config.safety.lost_hold_s:
        return ZoneState()
    return state.zone


def _observe(
    frame: DepthFrame,
    track: Track,
    state: IntentState,
    dt_s: float,
    true_dt_s: float,
    config: IntentConfig,
    read: HandReader,
) -> tuple[Gestures, IntentState]:
    """Everything that only a new frame can change, but for control, task and mode."""
    # who was seen to walk out is not waited for
    sight = step_sight(state.sight, track, true_dt_s, state.control.engaged and not state.leaving, config)
    body = sight.body if sight.seen_now else None
    mine = track.skeleton if body is not None else None
    skin = step_skin(None if sight.exchanged or track.reset else state.skin, frame, mine, config.hands)
    seen = read(frame, mine, config.hands, skin)
    zone = _zone(state, sight, body, dt_s, config)
    state = replace(
        state,
        sight=sight,
        skin=skin,
        gait=step_gait(state.gait, spine_xz_m(body), dt_s, config.task.gait_smoothing_s),
        zone=zone,
        leaving=state.leaving if body is None else Zone.OUT in (zone.zone, zone.candidate),
        right_hand=step_hand(state.right_hand, seen.right, seen.right_confidence, dt_s, config.hands),
        left_hand=step_hand(state.left_hand, seen.left, seen.left_confidence, dt_s, config.hands),
    )
    engage = crossed = False
    if body is not None:
        angles = body_angles(body, config.angles)
        engage = engage_pose(body, angles, settled_hands(state), config.engage)
        crossed = forearms_crossed(body, config.engage)
    gestures, memory = step_gestures(state.gestures, engage, crossed, dt_s, config.engage)
    return gestures, replace(state, gestures=memory, progress=gestures.progress)


def _legs(state: IntentState, config: IntentConfig) -> tuple[float | None, float | None]:
    """T1 and T2 of legs that are known well enough, and stand, to choose a task by.

    A walk to or from the sensor hardly spreads the legs, so it may be faster before T1 says nothing.
    """
    body = state.sight.body if state.sight.seen_now else None
    if body is None or body.confidence[LEGS].min() < config.mapping.min_confidence:
        return None, None
    T1_deg, T2_deg = leg_angles(body, config.angles)
    gait, task = state.gait, config.task
    spreads = gait.side_m_s > task.still_m_s or gait.ahead_m_s > task.ahead_m_s
    return None if spreads else T1_deg, None if gait.speed_m_s > task.still_m_s else T2_deg


def interpret(
    frame: DepthFrame | None,
    track: Track | None,
    state: IntentState,
    inputs: Inputs,
    now: Circumstances,
    config: IntentConfig,
    read: HandReader = read_hands,
) -> tuple[Intent, IntentState]:
    """One frame. None at all, or one that was refused, changes nothing but what the buttons ask for.

    read: the rule that reads the hands.
    """
    before = state
    dt_s = min(now.dt_s, config.safety.max_dt_s)
    if now.restarted:
        state = IntentState(mode=state.mode, control=state.control, shown_zone=state.shown_zone)
    gestures = Gestures(toggle=False, stop=state.mode is Mode.STOPPED and not state.control.estop, progress=0.0)
    if now.used and frame is not None and track is not None:
        gestures, state = _observe(frame, track, state, dt_s, now.dt_s, config, read)
    sight = state.sight
    seen = Seen(
        person=sight.body is not None,
        now=sight.seen_now,
        toggle=gestures.toggle,
        crossed=gestures.stop,
        exchanged=sight.exchanged and now.used,
        restarted=now.restarted,
    )
    control = step_control(state.control, seen, inputs)
    zone = state.zone.zone if seen.person else Zone.NONE
    task = TaskState()
    if zone is Zone.WORK and control.engaged:
        task = state.task
        if now.used:
            task = step_task(task, *_legs(state, config), dt_s, config.task)
    conditions = Conditions(
        person=seen.person,
        tracked=(sight.seen_now or (sight.lost_s <= config.safety.lost_hold_s and not state.leaving))
        and not inputs.source_failed,
        engaged=control.engaged,
        stopped=control.estop or gestures.stop,
        zone=zone,
        task=task.task,
        engage_reason=control.engage_reason,
        stop_reason=Reason.ESTOP if control.estop else Reason.BODY_STOP,
        end_reason=control.end_reason,
    )
    path = next_mode(state.mode, conditions)
    state = replace(state, control=control, task=task, mode=path[-1][0] if path else state.mode, shown_zone=zone)
    intent = Intent(
        t_ns=now.t_ns,
        zone=zone,
        mode=state.mode,
        angles=_shown_angles(sight, config) if now.used else NO_ANGLES,
        hands=settled_hands(state),
        spine_xz_m=spine_xz_m(sight.body if sight.seen_now else None),
        engage_progress=state.progress,
        reasons=_unique(now.reasons, sight.reasons if now.used else (), control.refusals),
        events=_events(now.t_ns, before, state, path),
    )
    return intent, state


def _shown_angles(sight: Sight, config: IntentConfig) -> BodyAngles:
    return NO_ANGLES if sight.shown is None else body_angles(sight.shown, config.angles)


def _unique(*groups: tuple[Reason, ...]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(str(reason) for group in groups for reason in group))


def _events(
    t_ns: int, before: IntentState, after: IntentState, path: tuple[tuple[Mode, Reason], ...]
) -> tuple[Event, ...]:
    """What happened once at this frame: e-stop, refusals, changes of mode and zone."""
    events: list[Event] = []
    if after.control.estop != before.control.estop:
        events.append(Event(t_ns, "estop", Reason.ESTOP if after.control.estop else Reason.ESTOP_RESET))
    events += [Event(t_ns, "refused", refusal) for refusal in after.control.refusals]
    mode = before.mode
    for new, reason in path:
        events.append(Event(t_ns, "mode", reason, f"{mode} -> {new}"))
        mode = new
    old, zone = before.shown_zone, after.shown_zone
    if zone is not old:
        reason = Reason.ZONE_ENTERED
        if zone is Zone.NONE:
            reason = Reason.PERSON_LEFT if before.leaving or after.sight.body is None else Reason.TRACKING_LOST
        events.append(Event(t_ns, "zone", reason, f"{old} -> {zone}"))
    return tuple(events)
