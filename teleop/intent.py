"""From a track to what the operator wants: level, gate, zones, task, hands, gestures, mode; one frame at a time."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from teleop.angles import NO_ANGLES, body_angles
from teleop.config.intent import IntentConfig
from teleop.engage import GestureState, engage_pose, forearms_crossed, step_gestures
from teleop.frames import DepthFrame
from teleop.hands.debounce import HandMemory, step_hand
from teleop.hands.reader import read_hands
from teleop.inputs import Inputs
from teleop.intent_types import Event, Hands, Intent, Mode, Zone
from teleop.jumps import JumpState, initial_jumps, step_jumps
from teleop.level import levelled, rotation_level_camera
from teleop.modes import Conditions, next_mode
from teleop.reasons import Reason
from teleop.skeleton import FloorPlane, Skeleton, Track
from teleop.task import TaskState, step_task
from teleop.zones import ZoneState, step_zone

MAX_DT_S = 0.25
"""A frame counts for no longer than this in dwells and gestures: a gap in time proves nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class IntentState:
    """Memory between frames. body: the gated, levelled skeleton of the last frame with one; lost_s: time since.

    engaged: an operator is in control. estop: latched. toggled_by: what engaged, for the events.
    """

    mode: Mode = Mode.NO_PERSON
    engaged: bool = False
    estop: bool = False
    zone: ZoneState = field(default_factory=ZoneState)
    task: TaskState = field(default_factory=TaskState)
    gestures: GestureState = field(default_factory=GestureState)
    right_hand: HandMemory = field(default_factory=HandMemory)
    left_hand: HandMemory = field(default_factory=HandMemory)
    jumps: JumpState = field(default_factory=initial_jumps)
    floor: FloorPlane | None = None
    body: Skeleton | None = None
    seen_now: bool = False
    lost_s: float = 0.0
    progress: float = 0.0


@dataclass(frozen=True, slots=True)
class Circumstances:
    """What the frame checks say about this frame. used: it brings new information; dt_s: since the last used one."""

    t_ns: int
    dt_s: float
    used: bool
    restarted: bool
    reasons: tuple[Reason, ...] = ()


def _see(
    track: Track, state: IntentState, now: Circumstances, config: IntentConfig
) -> tuple[Skeleton | None, bool, tuple[Reason, ...], IntentState]:
    """The gated, levelled body of this frame, whether the operator was exchanged, and reasons."""
    floor = track.floor if track.floor is not None else state.floor
    state = replace(state, floor=floor)
    if track.skeleton is None:
        return None, track.reset and state.body is not None, (), state
    jumps = initial_jumps() if track.reset else state.jumps
    gated, verdict, jumps = step_jumps(jumps, track.skeleton, now.dt_s, config.safety)
    changed = track.reset or verdict.operator_changed
    state = replace(state, jumps=jumps)
    if gated is None or gated.joint("spine") is None:
        return None, changed, verdict.reasons, state
    return levelled(gated, rotation_level_camera(floor, config.level)), changed, verdict.reasons, state


def _control(
    state: IntentState, inputs: Inputs, toggle: bool, crossed: bool, changed: bool, assume_engaged: bool
) -> tuple[bool, bool, Reason, Reason, tuple[Reason, ...]]:
    """Who is in control: engaged, estop, why engaged, why not any more, refusals."""
    refusals: list[Reason] = []
    estop = (state.estop and not inputs.estop_reset) or inputs.estop
    person = state.body is not None
    engaged, why, end = state.engaged, Reason.ENGAGE_REQUEST, Reason.DISENGAGE_REQUEST
    if assume_engaged and person and not engaged:
        engaged, why = True, Reason.ENGAGE_ASSUMED
    if changed and engaged and not assume_engaged:
        engaged, end = False, Reason.OPERATOR_CHANGED
    if toggle and not assume_engaged:
        if engaged:
            engaged, end = False, Reason.DISENGAGE_GESTURE
        elif estop:
            refusals.append(Reason.ENGAGE_ESTOP)
        else:
            engaged, why = True, Reason.ENGAGE_GESTURE
    if inputs.engage and not engaged:
        if estop:
            refusals.append(Reason.ENGAGE_ESTOP)
        elif not (person and state.seen_now):
            refusals.append(Reason.ENGAGE_NO_PERSON)
        else:
            engaged, why = True, Reason.ENGAGE_REQUEST
    if inputs.disengage and not assume_engaged:
        engaged, end = False, Reason.DISENGAGE_REQUEST
    if estop or crossed:
        engaged = False
    if not person:
        engaged, end = False, Reason.PERSON_LEFT
    return engaged, estop, why, end, tuple(refusals)


def _hands(frame: DepthFrame, track: Track, state: IntentState, dt_s: float, config: IntentConfig) -> IntentState:
    seen = read_hands(frame, track.skeleton, config.hands)
    if config.mapping.handedness == "left":
        seen = Hands(seen.left, seen.right, seen.left_confidence, seen.right_confidence)
    return replace(
        state,
        right_hand=step_hand(state.right_hand, seen.right, seen.right_confidence, dt_s, config.hands),
        left_hand=step_hand(state.left_hand, seen.left, seen.left_confidence, dt_s, config.hands),
    )


def settled_hands(state: IntentState) -> Hands:
    """Both hands after debouncing."""
    right, left = state.right_hand, state.left_hand
    return Hands(right.settled, left.settled, right.confidence, left.confidence)


def interpret(
    frame: DepthFrame,
    track: Track,
    state: IntentState,
    inputs: Inputs,
    now: Circumstances,
    config: IntentConfig,
    assume_engaged: bool = False,
) -> tuple[Intent, IntentState]:
    """One frame. A frame that was refused repeats what was known; buttons count all the same."""
    before = state
    dt_s = min(now.dt_s, MAX_DT_S)
    events: list[Event] = []
    reasons = list(now.reasons)
    if now.restarted:
        state = IntentState(estop=state.estop, mode=state.mode, engaged=state.engaged, body=state.body)
    changed = now.restarted
    crossed = toggle = False
    if now.used:
        body, exchanged, why, state = _see(track, state, now, config)
        changed = changed or exchanged
        reasons += why
        lost_s = 0.0 if body is not None else state.lost_s + now.dt_s
        kept = body if body is not None or lost_s > config.safety.lost_disengage_s else state.body
        if body is None and (changed or not state.engaged):
            kept = None
        state = replace(state, body=kept if body is None else body, seen_now=body is not None, lost_s=lost_s)
        state = _hands(frame, track if body is not None else replace(track, skeleton=None), state, dt_s, config)
        spine = None if body is None else body.joint("spine")
        xz = None if spine is None else (float(spine[0]), float(spine[2]))
        state = replace(state, zone=step_zone(state.zone, xz, dt_s, config.zones) if state.body else ZoneState())
    angles = body_angles(state.body, config.angles) if state.body is not None and state.seen_now else NO_ANGLES
    hands = settled_hands(state)
    if now.used:
        pose = state.seen_now and state.body is not None
        engage = pose and engage_pose(state.body, angles, hands, config.engage)  # type: ignore[arg-type]
        cross = pose and forearms_crossed(state.body, config.engage)  # type: ignore[arg-type]
        gestures, memory = step_gestures(state.gestures, engage, cross, dt_s, config.engage)
        toggle, crossed = gestures.toggle, gestures.stop
        state = replace(state, gestures=memory, progress=gestures.progress)
    else:
        crossed = state.mode is Mode.STOPPED and not state.estop
    engaged, estop, engage_why, end_why, refusals = _control(state, inputs, toggle, crossed, changed, assume_engaged)
    if now.restarted and end_why is Reason.OPERATOR_CHANGED:
        end_why = Reason.STREAM_RESTARTED
    if before.estop and not estop:
        events.append(Event(now.t_ns, "estop", Reason.ESTOP_RESET))
    if estop and not before.estop:
        events.append(Event(now.t_ns, "estop", Reason.ESTOP))
    events += [Event(now.t_ns, "refused", refusal) for refusal in refusals]
    reasons += refusals
    zone = state.zone.zone if state.body is not None else Zone.NONE
    if zone is Zone.WORK and engaged:
        task = state.task
        if now.used:
            task = step_task(task, angles.T1_deg, angles.T2_deg, dt_s, config.task)
    else:
        task = TaskState()
    state = replace(state, engaged=engaged, estop=estop, task=task)
    conditions = Conditions(
        person=state.body is not None,
        tracked=state.lost_s <= config.safety.lost_hold_s and not inputs.source_failed,
        engaged=engaged,
        stopped=estop or crossed,
        zone=zone,
        task=task.task,
        engage_reason=engage_why,
        stop_reason=Reason.ESTOP if estop else Reason.BODY_STOP,
        end_reason=end_why,
    )
    mode = state.mode
    for new, why_mode in next_mode(mode, conditions):
        events.append(Event(now.t_ns, "mode", why_mode, f"{mode} -> {new}"))
        mode = new
    if zone is not before.zone.zone and state.body is not None:
        events.append(Event(now.t_ns, "zone", Reason.ZONE_ENTERED, f"{before.zone.zone} -> {zone}"))
    state = replace(state, mode=mode)
    spine = state.body.joint("spine") if state.body is not None and state.seen_now else None
    intent = Intent(
        t_ns=now.t_ns,
        zone=zone,
        mode=mode,
        angles=angles,
        hands=hands,
        spine_xz_m=None if spine is None else (float(spine[0]), float(spine[2])),
        engage_progress=state.progress,
        reasons=tuple(dict.fromkeys(str(r) for r in reasons)),
        events=tuple(events),
    )
    return intent, state
