"""The safety kernel: the one way from intent and requests to a robot command."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Final

from robot_sim.commands import ArmName, ArmTarget, RobotCommand
from teleop.angles import arm_angles
from teleop.assist.overlay import arms_as_they_are, laid_over, ran, tools_as_they_are
from teleop.assist.step import Assisted, AssistState, Situation, step_assist
from teleop.assist.task import RobotView
from teleop.config.intent import DriveConfig, IntentConfig
from teleop.engage import hand_beside_head
from teleop.inputs import PickAsk, RobotRequest
from teleop.intent_types import Event, Hands, Intent, Mode, Side, Zone
from teleop.mapping import ArmMemory, Measured, eased_from, measure, step_arm
from teleop.modes import ACTING, IN_CONTROL, WORKING
from teleop.reasons import Reason
from teleop.skeleton import Skeleton
from teleop.tools import ToolState, rest, step_tools, tool_events

DRIVEN: Final[dict[Mode, tuple[tuple[Side, ArmName], ...]]] = {
    Mode.PICKING: (("right", "right"), ("left", "left")),
    Mode.SPRAYING: (("right", "rear"),),
}
"""Which operator arm drives which robot arm; the others are locked (specification, section 4)."""
DISC_RAD: Final = {Mode.PICKING: 0.0, Mode.SPRAYING: math.pi}
"""Where the disc stands in each task: spraying brings the rear arm to the crop (specification, section 6)."""


def _resting_arms() -> dict[ArmName, ArmMemory]:
    return {"right": ArmMemory(), "left": ArmMemory(), "rear": ArmMemory()}


@dataclass(frozen=True, slots=True)
class KernelState:
    """What was commanded last. disc_wait_s: the disc still turns for so long, arms and tools stay locked.

    disc_rad: where the disc was sent, None when it was stopped on its way. acting: the mode let the robot move.
    """

    task: Mode | None = None
    arms: dict[ArmName, ArmMemory] = field(default_factory=_resting_arms)
    tools: ToolState = field(default_factory=ToolState)
    disc_rad: float | None = 0.0
    disc_wait_s: float = 0.0
    acting: bool = False
    assist: AssistState = field(default_factory=AssistState)
    events: tuple[Event, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """What the kernel must know of this frame beside the intent.

    body: the gated, levelled skeleton, None when it is not tracked right now. dt_s: 0 for a refused frame.
    zone_settled: the operator stands in the zone that counts. robot: for the assisted pick; None: there is none.
    """

    body: Skeleton | None
    dt_s: float
    zone_settled: bool
    estop: bool
    head_camera_sweep: bool
    robot: RobotView | None = None


def step_kernel(
    intent: Intent,
    moment: Moment,
    state: KernelState,
    request: RobotRequest | None,
    config: IntentConfig,
    picks: tuple[PickAsk, ...] = (),
) -> tuple[RobotCommand, KernelState]:
    """One frame: the command with the reasons for everything that does not move, and the next state."""
    before = state
    state = _enter(
        replace(state, events=(), disc_wait_s=max(0.0, state.disc_wait_s - moment.dt_s)), intent.mode, config
    )
    acting = intent.mode in ACTING
    # goals already sent are dropped at the end of motion, and for as long as the robot is stopped
    stand_still = intent.mode is Mode.STOPPED or (before.acting and not acting)
    if stand_still and state.disc_wait_s > 0:
        state = replace(state, disc_rad=None, disc_wait_s=0.0)
    state = replace(state, acting=acting)
    command = RobotCommand(
        intent.t_ns,
        stand_still=stand_still,
        cutter_closed=False,
        liquid=state.tools.liquid,
        disc_rad=None if state.task is None else state.disc_rad,
        head_camera_sweep=moment.head_camera_sweep,
    )
    still = _why_still(intent, moment, config)
    assisted = step_assist(
        state.assist, _situation(intent, moment, state, request, still, config), picks, moment.robot, config.assist
    )
    why: tuple[Reason, ...] = ()
    if still is not None:
        why = (still,)
        state = _ease_anew(state) if still is Reason.GESTURE else state
        state = replace(state, tools=replace(state.tools, spray_on=False))
    elif assisted.holds:
        state = _ease_anew(replace(state, tools=rest(state.tools)))
    elif state.task is not None:
        state, command, why = _work(state.task, intent.hands, moment, state, command, config)
    else:
        command = _cruise(intent.mode, command, config.drive)
    state = replace(state, events=tool_events(intent.t_ns, before.tools, state.tools))
    command, state = _assist(command, state, assisted, moment.robot)
    if request is not None:
        command, state, refused = apply_request(command, request, state, intent.mode, moment.estop, config)
        if refused is not None:
            why = (*why, refused)
            state = replace(state, events=(Event(intent.t_ns, "refused", refused), *state.events))
    if state.disc_wait_s > 0:
        command = replace(command, right_arm=None, left_arm=None, rear_arm=None, gripper_open=None, spray_on=False)
        why = (*why, Reason.DISC_TURNING)
    reasons = (*intent.reasons, *(str(reason) for reason in why), *assisted.reasons)
    return replace(command, reasons=tuple(dict.fromkeys(reasons))), state


def step_between(
    command: RobotCommand,
    state: KernelState,
    now: Situation,
    request: RobotRequest | None,
    picks: tuple[PickAsk, ...],
    robot: RobotView | None,
    config: IntentConfig,
) -> tuple[RobotCommand, KernelState]:
    """A step between two frames, or without any: requests and the assisted pick over the command that stands."""
    assisted = step_assist(state.assist, now, picks, robot, config.assist)
    command, state = _assist(command, replace(state, events=()), assisted, robot)
    refused: Reason | None = None
    if request is not None:
        estop = now.stopped is Reason.ESTOP
        command, state, refused = apply_request(command, request, state, now.mode, estop, config)
    if refused is not None:
        state = replace(state, events=(Event(now.t_ns, "refused", refused), *state.events))
    reasons = (*command.reasons, *assisted.reasons, *((refused,) if refused else ()))
    return replace(command, reasons=tuple(dict.fromkeys(map(str, reasons)))), state


def _situation(
    intent: Intent,
    moment: Moment,
    state: KernelState,
    request: RobotRequest | None,
    still: Reason | None,
    config: IntentConfig,
) -> Situation:
    """What the assisted pick must know of this frame."""
    side, other = _operator_side("right", config), _operator_side("left", config)
    raised = False
    if moment.body is not None and not still:
        elbow_deg = arm_angles(moment.body, other, config.angles).theta3_deg
        raised = hand_beside_head(moment.body, other, elbow_deg, config.engage)
    in_control = intent.mode in IN_CONTROL
    return Situation(
        t_ns=intent.t_ns,
        mode=intent.mode,
        hands=intent.hands if side == "right" else swapped(intent.hands),
        body=moment.body,
        pointing=side,
        raised=raised,
        dt_s=moment.dt_s,
        still=Reason.DISC_TURNING if state.disc_wait_s > 0 else still if in_control else None,
        stopped=still if intent.mode is Mode.STOPPED else None,
        manual=request is not None,
    )


def _assist(
    command: RobotCommand, state: KernelState, assisted: Assisted, robot: RobotView | None
) -> tuple[RobotCommand, KernelState]:
    """The assisted pick's part of a step."""
    if robot is not None and ran(state.assist, assisted.state):
        tools, arms = tools_as_they_are(state.tools, robot), arms_as_they_are(state.arms, robot)
        state = replace(state, tools=tools, arms=arms)
    state = replace(state, assist=assisted.state, events=(*state.events, *assisted.events))
    return laid_over(command, assisted), state


def _enter(state: KernelState, mode: Mode, config: IntentConfig) -> KernelState:
    """Begin or end a task: tools rest until their hand changes, arms ease in, the disc turns to its side."""
    task = mode if mode in WORKING else None
    if task is state.task:
        return state
    state = replace(state, task=task, tools=rest(state.tools))
    return state if task is None else _ease_anew(turn_disc(state, DISC_RAD[task], config))


def turn_disc(state: KernelState, disc_rad: float, config: IntentConfig) -> KernelState:
    """Send the disc somewhere and lock the arms for as long as it turns."""
    angle_rad = math.pi if state.disc_rad is None else abs(disc_rad - state.disc_rad)
    wait_s = angle_rad / math.pi * config.mapping.disc_half_turn_s
    return replace(state, disc_rad=disc_rad, disc_wait_s=max(state.disc_wait_s, wait_s))


def _ease_anew(state: KernelState) -> KernelState:
    return replace(state, arms={name: replace(memory, easing=True) for name, memory in state.arms.items()})


def _why_still(intent: Intent, moment: Moment, config: IntentConfig) -> Reason | None:
    """Why nothing may move at this frame; None when it may."""
    if intent.mode not in ACTING:
        return {
            Mode.STOPPED: Reason.ESTOP if moment.estop else Reason.BODY_STOP,
            Mode.NO_PERSON: Reason.NO_PERSON,
            Mode.SEEN: Reason.NOT_ENGAGED,
            Mode.HELD: Reason.OUT_OF_RANGE if intent.zone is Zone.OUT else Reason.TRACKING_LOST,
            Mode.ENGAGED: Reason.TASK_UNSETTLED if intent.zone is Zone.WORK else Reason.ZONE_UNSETTLED,
        }[intent.mode]
    if intent.engage_progress > config.engage.hold_progress:
        return Reason.GESTURE
    return None if moment.zone_settled else Reason.ZONE_UNSETTLED


def _cruise(mode: Mode, command: RobotCommand, config: DriveConfig) -> RobotCommand:
    drive_m_s, turn_rad_s = {
        Mode.FORWARD: (config.forward_m_s, 0.0),
        Mode.BACK: (-config.back_m_s, 0.0),
        Mode.LEFT: (0.0, config.turn_rad_s),
        Mode.RIGHT: (0.0, -config.turn_rad_s),
    }[mode]
    return replace(command, drive_m_s=drive_m_s, turn_rad_s=turn_rad_s)


def _work(
    task: Mode, hands: Hands, moment: Moment, state: KernelState, command: RobotCommand, config: IntentConfig
) -> tuple[KernelState, RobotCommand, tuple[Reason, ...]]:
    """One frame of a task: arms and tools, or the last set-points for a moment without the operator."""
    why: list[Reason] = [Reason.ARM_LOCKED]
    if moment.body is None:
        why.append(Reason.TRACKING_LOST)
    elif moment.dt_s > 0:
        side = _operator_side("right", config)
        tools, tool_reasons = step_tools(
            state.tools, task, hands if side == "right" else swapped(hands), arm_hangs(moment.body, side, config)
        )
        state = replace(state, tools=tools)
        why += tool_reasons
        if state.disc_wait_s <= 0:
            arms, arm_reasons = _arms(task, moment.body, moment.dt_s, state.arms, config)
            state = replace(state, arms=arms)
            why += arm_reasons
    targets = {arm: state.arms[arm].target for _, arm in DRIVEN[task]}
    tools = state.tools
    command = replace(
        command,
        right_arm=targets.get("right"),
        left_arm=targets.get("left"),
        rear_arm=targets.get("rear"),
        gripper_open=tools.gripper_open if task is Mode.PICKING and tools.right_changed else None,
        cutter_closed=tools.cutter_closed,
        spray_on=tools.spray_on,
        liquid=tools.liquid,
    )
    return state, command, tuple(why)


def swapped(hands: Hands) -> Hands:
    """The hands in each other's role, for left-handed operators."""
    return Hands(hands.left, hands.right, hands.left_confidence, hands.right_confidence)


def _operator_side(role: Side, config: IntentConfig) -> Side:
    """The operator's arm in that role: the other one for left-handed operators."""
    if config.mapping.handedness == "right":
        return role
    return "left" if role == "right" else "right"


def arm_hangs(body: Skeleton, side: Side, config: IntentConfig) -> bool:
    """Whether an arm hangs straight down; one that is not known counts as hanging."""
    angles = arm_angles(body, side, config.angles)
    if angles.theta3_deg is None:
        return True
    raised_deg = max(angles.theta1_deg or 0.0, angles.theta2_deg or 0.0)
    return angles.theta3_deg >= config.mapping.hanging_elbow_deg and raised_deg <= config.mapping.hanging_deg


def _arms(
    task: Mode, body: Skeleton, dt_s: float, memories: dict[ArmName, ArmMemory], config: IntentConfig
) -> tuple[dict[ArmName, ArmMemory], tuple[Reason, ...]]:
    """One frame of the arms that the task drives."""
    right, left = body.joint("shoulder_right"), body.joint("shoulder_left")
    facing = right is None or left is None or right[0] - left[0] >= config.mapping.min_facing_m
    arms, reasons = dict(memories), list[Reason]()
    for role, arm in DRIVEN[task]:
        side = _operator_side(role, config)
        wanted = Measured(reasons=(Reason.NOT_FACING,))
        if facing:
            wanted = measure(body, side, config.mapping, config.angles)
        arms[arm], why = step_arm(arms[arm], wanted, dt_s, config.mapping)
        reasons += why
    return arms, tuple(reasons)


def apply_request(
    command: RobotCommand,
    request: RobotRequest,
    state: KernelState,
    mode: Mode,
    estop: bool,
    config: IntentConfig,
) -> tuple[RobotCommand, KernelState, Reason | None]:
    """Console and API: lift and disc at any time but under e-stop, the rest only while no operator is in control.

    Returns the command, the state, and why a part of the request was refused.
    """
    if estop:
        return command, state, Reason.REQUEST_ESTOP
    if not request.finite:
        return command, state, Reason.REQUEST_NOT_FINITE
    command = command if request.lift_m is None else replace(command, lift_m=request.lift_m)
    if request.disc_rad is not None:
        state = turn_disc(state, request.disc_rad, config)
        command = replace(command, disc_rad=request.disc_rad)
    if request == RobotRequest(lift_m=request.lift_m, disc_rad=request.disc_rad):
        return command, state, None
    if mode in IN_CONTROL:
        return command, state, Reason.REQUEST_ENGAGED
    if mode is Mode.STOPPED:
        return command, state, Reason.BODY_STOP
    arms = dict(state.arms)
    asked: tuple[tuple[ArmName, ArmTarget | None], ...] = (
        ("right", request.right_arm),
        ("left", request.left_arm),
        ("rear", request.rear_arm),
    )
    for name, target in asked:
        if target is not None:
            arms[name] = eased_from(target)
    liquid = state.tools.liquid if request.liquid is None else request.liquid
    gripper_open = state.tools.gripper_open if request.gripper_open is None else request.gripper_open
    command = replace(
        command,
        drive_m_s=request.drive_m_s or 0.0,
        turn_rad_s=request.turn_rad_s or 0.0,
        right_arm=request.right_arm,
        left_arm=request.left_arm,
        rear_arm=request.rear_arm,
        gripper_open=request.gripper_open,
        cutter_closed=bool(request.cutter_closed),
        spray_on=bool(request.spray_on),
        liquid=liquid,
        head_camera_sweep=bool(request.head_camera_sweep),
    )
    tools = replace(state.tools, liquid=liquid, gripper_open=gripper_open)
    return command, replace(state, arms=arms, tools=tools), None
