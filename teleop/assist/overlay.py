"""Between the kernel and the assisted pick: what the pick is told, and what its wish makes of a command. Pure."""

from __future__ import annotations

from dataclasses import replace

from robot_sim.arm_angles import arm_target
from robot_sim.commands import ArmName, RobotCommand
from teleop.assist.step import Assisted, AssistState
from teleop.assist.task import RobotView, TaskStatus
from teleop.mapping import ArmMemory, eased_from
from teleop.tools import ToolState


def laid_over(command: RobotCommand, assisted: Assisted) -> RobotCommand:
    """The kernel's command with what the assisted pick asks for; without a wish arms and tools keep what they have."""
    if not (assisted.holds or assisted.stops):
        return command
    held = replace(
        command,
        drive_m_s=0.0,
        turn_rad_s=0.0,
        right_arm=None,
        left_arm=None,
        rear_arm=None,
        gripper_open=None,
        cutter_closed=False,
        spray_on=False,
        stand_still=command.stand_still or assisted.stops,
    )
    wish = assisted.wish
    if wish is None or assisted.stops:
        return held
    return replace(
        held,
        drive_m_s=wish.drive_m_s,
        right_arm=wish.right_arm,
        left_arm=wish.left_arm,
        gripper_open=wish.gripper_open,
        cutter_closed=wish.cutter_closed,
        lift_m=wish.lift_m,
    )


def ran(before: AssistState, after: AssistState) -> bool:
    """Whether a pick that was running has just ended."""
    was = before.active
    return was is not None and was.status is TaskStatus.RUNNING and after.active is None


def arms_as_they_are(arms: dict[ArmName, ArmMemory], view: RobotView) -> dict[ArmName, ArmMemory]:
    """Memories of arms that ease in from where a pick has left them."""
    driven: tuple[ArmName, ArmName] = ("right", "left")
    return arms | {name: eased_from(arm_target(view.state.joint_rad, name)) for name in driven}


def tools_as_they_are(tools: ToolState, view: RobotView) -> ToolState:
    """Tools after a pick: as they are, until their hand changes anew."""
    return ToolState(gripper_open=view.state.gripper_open, liquid=tools.liquid)
