"""The safety kernel: the one way from intent and requests to a robot command."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Final

from robot_sim.commands import ArmName, ArmTarget, Liquid, RobotCommand
from teleop.config.intent import IntentConfig
from teleop.inputs import Inputs, RobotRequest
from teleop.intent_types import Event, Intent, Mode, Side
from teleop.mapping import ArmMemory, Measured, eased_from, measure, step_arm
from teleop.modes import ACTING, IN_CONTROL, WORKING
from teleop.reasons import Reason
from teleop.skeleton import Skeleton
from teleop.tools import ToolState, rest, step_tools

DRIVEN: Final[dict[Mode, tuple[tuple[Side, ArmName], ...]]] = {
    Mode.PICKING: (("right", "right"), ("left", "left")),
    Mode.SPRAYING: (("right", "rear"),),
}
"""Which operator arm drives which robot arm; the others are locked (specification, section 4)."""
DISC_RAD: Final = {Mode.PICKING: 0.0, Mode.SPRAYING: math.pi}
"""Where the disc stands in each task: spraying brings the rear arm to the crop (specification, section 6)."""


@dataclass(frozen=True, slots=True)
class KernelState:
    """What was commanded last. disc_wait_s: the arms stay locked for so long, the disc is turning."""

    task: Mode | None = None
    arms: dict[ArmName, ArmMemory] = field(default_factory=lambda: {n: ArmMemory() for n in ("right", "left", "rear")})
    tools: ToolState = field(default_factory=ToolState)
    disc_rad: float = 0.0
    disc_wait_s: float = 0.0
    events: tuple[Event, ...] = ()


def _turn_disc(state: KernelState, disc_rad: float, config: IntentConfig) -> KernelState:
    wait_s = abs(disc_rad - state.disc_rad) / math.pi * config.mapping.disc_half_turn_s
    return replace(state, disc_rad=disc_rad, disc_wait_s=max(state.disc_wait_s, wait_s))


def _facing(body: Skeleton, config: IntentConfig) -> bool:
    right, left = body.joint("shoulder_right"), body.joint("shoulder_left")
    return right is None or left is None or bool(right[0] - left[0] >= config.mapping.min_facing_m)


def _operator_side(side: Side, config: IntentConfig) -> Side:
    """The operator's arm that plays the role of ``side``: the other one for left-handed operators."""
    if config.mapping.handedness == "right":
        return side
    return "left" if side == "right" else "right"


def _arms(
    state: KernelState, task: Mode, body: Skeleton, dt_s: float, config: IntentConfig
) -> tuple[KernelState, tuple[Reason, ...]]:
    """One frame of the arms that the task drives."""
    reasons: list[Reason] = []
    arms = dict(state.arms)
    for role, arm in DRIVEN[task]:
        side = _operator_side(role, config)
        wanted = (
            measure(body, side, config.mapping, config.angles)
            if _facing(body, config)
            else Measured(reasons=(Reason.NOT_FACING,))
        )
        arms[arm], why = step_arm(arms[arm], wanted, dt_s, config.mapping)
        reasons += why
    return replace(state, arms=arms), tuple(reasons)


def _ease_anew(state: KernelState) -> KernelState:
    return replace(state, arms={name: replace(memory, easing=True) for name, memory in state.arms.items()})


def step_kernel(
    intent: Intent,
    body: Skeleton | None,
    state: KernelState,
    inputs: Inputs,
    dt_s: float,
    unsettled: bool,
    estop: bool,
    config: IntentConfig,
) -> tuple[RobotCommand, KernelState]:
    """One frame.

    body: the gated, levelled skeleton of this frame, None when it is not tracked right now. dt_s: since the last used
    frame, 0 for a refused one. unsettled: the operator stands outside the zone that counts.
    """
    before, mode = state, intent.mode
    state = replace(state, events=(), disc_wait_s=max(0.0, state.disc_wait_s - dt_s))
    reasons: list[str] = list(intent.reasons)
    task = mode if mode in WORKING else None
    if task is not None and task is not state.task:
        state = _ease_anew(_turn_disc(replace(state, tools=rest(state.tools)), DISC_RAD[task], config))
    if task is None:
        state = replace(state, tools=rest(state.tools))
    state = replace(state, task=task)
    command = RobotCommand(t_ns=intent.t_ns, gripper_open=None, cutter_closed=False, liquid=state.tools.liquid)
    if mode not in ACTING:
        reasons.append(_why_still(intent, estop))
    elif intent.engage_progress > config.engage.hold_progress:
        reasons.append(Reason.GESTURE)
        state = _ease_anew(state)
    elif unsettled:
        reasons.append(Reason.ZONE_UNSETTLED)
    elif task is not None:
        state, command, why = _work(task, intent, body, state, command, dt_s, config)
        reasons += why
    else:
        command = _cruise(mode, command, config)
    if inputs.request is not None:
        command, state, refused = apply_request(command, inputs.request, state, mode, estop, config)
        if refused is not None:
            reasons.append(refused)
            state = replace(state, events=(*state.events, Event(intent.t_ns, "refused", refused)))
    if state.disc_wait_s > 0:
        command = replace(command, right_arm=None, left_arm=None, rear_arm=None, spray_on=False, gripper_open=None)
        reasons.append(Reason.DISC_TURNING)
    command = replace(
        command, disc_rad=state.disc_rad if state.disc_rad != before.disc_rad or task else command.disc_rad
    )
    state = replace(state, events=(*state.events, *_tool_events(intent.t_ns, before, state)))
    return replace(command, reasons=tuple(dict.fromkeys(str(r) for r in reasons))), state


def _why_still(intent: Intent, estop: bool) -> Reason:
    mode = intent.mode
    if mode is Mode.STOPPED:
        return Reason.ESTOP if estop else Reason.BODY_STOP
    if mode is Mode.NO_PERSON:
        return Reason.NO_PERSON
    if mode is Mode.SEEN:
        return Reason.NOT_ENGAGED
    if mode is Mode.HELD:
        return Reason.TRACKING_LOST if intent.spine_xz_m is None else Reason.OUT_OF_RANGE
    return Reason.TASK_UNSETTLED if intent.zone == "work" else Reason.ZONE_UNSETTLED


def _cruise(mode: Mode, command: RobotCommand, config: IntentConfig) -> RobotCommand:
    drive, turn = {
        Mode.FORWARD: (config.drive.forward_m_s, 0.0),
        Mode.BACK: (-config.drive.back_m_s, 0.0),
        Mode.LEFT: (0.0, config.drive.turn_rad_s),
        Mode.RIGHT: (0.0, -config.drive.turn_rad_s),
    }[mode]
    return replace(command, drive_m_s=drive, turn_rad_s=turn)


def _work(
    task: Mode,
    intent: Intent,
    body: Skeleton | None,
    state: KernelState,
    command: RobotCommand,
    dt_s: float,
    config: IntentConfig,
) -> tuple[KernelState, RobotCommand, tuple[Reason, ...]]:
    reasons: list[Reason] = [Reason.ARM_LOCKED]
    if body is None:
        # for a moment without the operator the last set-points stand
        reasons.append(Reason.TRACKING_LOST)
    elif state.disc_wait_s <= 0:
        state, why = _arms(state, task, body, dt_s, config)
        reasons += why
    if state.disc_wait_s <= 0:
        tools, why = step_tools(state.tools, task, intent.hands)
        state = replace(state, tools=tools)
        reasons += why
    targets: dict[ArmName, ArmTarget] = {arm: state.arms[arm].target for _, arm in DRIVEN[task]}
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
    return state, command, tuple(reasons)


def apply_request(
    command: RobotCommand,
    request: RobotRequest,
    state: KernelState,
    mode: Mode,
    estop: bool,
    config: IntentConfig,
) -> tuple[RobotCommand, KernelState, Reason | None]:
    """Console and API. Lift and disc at any time but under e-stop; the rest only while no operator is in control."""
    if estop:
        return command, state, Reason.REQUEST_ESTOP
    if not request.finite:
        return command, state, Reason.REQUEST_NOT_FINITE
    refused: Reason | None = None
    command = replace(command, lift_m=request.lift_m)
    if request.disc_rad is not None:
        state = _turn_disc(state, request.disc_rad, config)
    others = RobotRequest(lift_m=request.lift_m, disc_rad=request.disc_rad)
    if request == others:
        return command, state, None
    if mode in IN_CONTROL or mode is Mode.STOPPED:
        return command, state, Reason.REQUEST_ENGAGED if mode in IN_CONTROL else Reason.BODY_STOP
    arms = dict(state.arms)
    for name, target in (("right", request.right_arm), ("left", request.left_arm), ("rear", request.rear_arm)):
        if target is not None:
            arms[name] = eased_from(target)  # type: ignore[index]
    tools = state.tools
    tools = replace(
        tools,
        gripper_open=tools.gripper_open if request.gripper_open is None else request.gripper_open,
        liquid=request.liquid or tools.liquid,
    )
    command = replace(
        command,
        drive_m_s=request.drive_m_s or 0.0,
        turn_rad_s=request.turn_rad_s or 0.0,
        right_arm=request.right_arm,
        left_arm=request.left_arm,
        rear_arm=request.rear_arm,
        gripper_open=request.gripper_open,
        cutter_closed=request.cutter_closed or False,
        spray_on=request.spray_on or False,
        liquid=tools.liquid,
        head_camera_sweep=request.head_camera_sweep or False,
    )
    return command, replace(state, arms=arms, tools=tools), refused


def _tool_events(t_ns: int, before: KernelState, after: KernelState) -> list[Event]:
    events: list[Event] = []
    if before.tools.spray_on != after.tools.spray_on:
        events.append(Event(t_ns, "tool", "spray_on" if after.tools.spray_on else "spray_off"))
    if before.tools.cutter_closed != after.tools.cutter_closed:
        events.append(Event(t_ns, "tool", "cutter_closed" if after.tools.cutter_closed else "cutter_open"))
    if before.tools.gripper_open is not after.tools.gripper_open and after.tools.gripper_open is not None:
        events.append(Event(t_ns, "tool", "gripper_open" if after.tools.gripper_open else "gripper_closed"))
    if before.tools.liquid is not after.tools.liquid:
        events.append(Event(t_ns, "tool", "liquid", Liquid(after.tools.liquid)))
    return events
