"""The safety kernel: the one way from intent and requests to a robot command."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from robot_sim.commands import RobotCommand
from robot_sim.posture import Posture
from teleop.angles import arm_angles
from teleop.assist.overlay import arms_as_they_are, laid_over, ran, tools_as_they_are
from teleop.assist.step import Assisted, Situation, step_assist
from teleop.assist.task import RobotView
from teleop.config.intent import DriveConfig, IntentConfig
from teleop.engage import hand_beside_head
from teleop.inputs import PickAsk, RobotRequest
from teleop.intent_types import Event, Intent, Mode, Zone
from teleop.kernel_state import KernelState, Moment, ease_anew, posture_of, turn_disc
from teleop.modes import ACTING, IN_CONTROL, WORKING
from teleop.reasons import Reason
from teleop.requests import Asked, apply_request
from teleop.tools import rest, tool_events
from teleop.work import operator_side, step_work, swapped

DISC_RAD: Final = {Mode.PICKING: 0.0, Mode.SPRAYING: math.pi}
"""Where the disc stands in each task: spraying brings the rear arm to the crop (specification, section 6)."""


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
    stands = moment.posture
    state = replace(state, events=(), disc_wait_s=max(0.0, state.disc_wait_s - moment.dt_s))
    state = _enter(state, intent.mode, stands, config)
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
    if still is Reason.GESTURE or moment.interrupted:
        state = ease_anew(state, stands)
    if still is not None or moment.interrupted:
        state = replace(state, tools=replace(state.tools, spray_on=False))
    if still is not None:
        why = (still,)
    elif assisted.holds:
        state = ease_anew(replace(state, tools=rest(state.tools)), stands)
    elif state.task is not None:
        state, command, why = step_work(state.task, intent.hands, moment, state, command, config)
    else:
        command = _cruise(intent.mode, command, config.drive)
    state = replace(state, events=tool_events(intent.t_ns, before.tools, state.tools))
    command, state = _assist(command, state, assisted, moment.robot)
    if request is not None:
        asked = Asked(request, intent.mode, moment.estop, stands)
        command, state, refused = apply_request(command, asked, state, config)
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
        asked = Asked(request, now.mode, now.stopped is Reason.ESTOP, posture_of(robot))
        command, state, refused = apply_request(command, asked, state, config)
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
    side, other = operator_side("right", config), operator_side("left", config)
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


def _enter(state: KernelState, mode: Mode, stands: Posture | None, config: IntentConfig) -> KernelState:
    """Begin or end a task: tools rest until their hand changes, arms ease in, the disc turns to its side."""
    task = mode if mode in WORKING else None
    if task is state.task:
        return state
    state = replace(state, task=task, tools=rest(state.tools))
    return state if task is None else ease_anew(turn_disc(state, DISC_RAD[task], stands, config), stands)


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
    if moment.crossing:
        return Reason.CROSSING
    return None if moment.zone_settled else Reason.ZONE_UNSETTLED


def _cruise(mode: Mode, command: RobotCommand, config: DriveConfig) -> RobotCommand:
    drive_m_s, turn_rad_s = {
        Mode.FORWARD: (config.forward_m_s, 0.0),
        Mode.BACK: (-config.back_m_s, 0.0),
        Mode.LEFT: (0.0, config.turn_rad_s),
        Mode.RIGHT: (0.0, -config.turn_rad_s),
    }[mode]
    return replace(command, drive_m_s=drive_m_s, turn_rad_s=turn_rad_s)
