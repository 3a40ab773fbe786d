"""One frame of picking or spraying by hand: the operator's arms and hands to set-points and tools."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from robot_sim.commands import ArmName, RobotCommand
from teleop.angles import arm_angles
from teleop.config.intent import IntentConfig
from teleop.intent_types import Hands, Mode, Side
from teleop.kernel_state import KernelState, Moment
from teleop.mapping import ArmMemory, Measured, measure, step_arm
from teleop.reasons import Reason
from teleop.skeleton import Skeleton
from teleop.tools import step_tools

DRIVEN: Final[dict[Mode, tuple[tuple[Side, ArmName], ...]]] = {
    Mode.PICKING: (("right", "right"), ("left", "left")),
    Mode.SPRAYING: (("right", "rear"),),
}
"""Which operator arm drives which robot arm; the others are locked (specification, section 4)."""


def step_work(
    task: Mode, hands: Hands, moment: Moment, state: KernelState, command: RobotCommand, config: IntentConfig
) -> tuple[KernelState, RobotCommand, tuple[Reason, ...]]:
    """One frame of a task: arms and tools, or the last set-points for a moment without the operator."""
    why: list[Reason] = [Reason.ARM_LOCKED]
    if moment.body is None:
        why.append(Reason.TRACKING_LOST)
    elif moment.dt_s > 0:
        side = operator_side("right", config)
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


def operator_side(role: Side, config: IntentConfig) -> Side:
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
        side = operator_side(role, config)
        wanted = Measured(reasons=(Reason.NOT_FACING,))
        if facing:
            wanted = measure(body, side, config.mapping, config.angles)
        arms[arm], why = step_arm(arms[arm], wanted, dt_s, config.mapping)
        reasons += why
    return arms, tuple(reasons)
