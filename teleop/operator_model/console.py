"""What the console paints of one moment: all that an operator model may know."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from robot_sim.commands import ArmName, ArmTarget
from robot_sim.primitives import Primitive
from robot_sim.state import RobotState
from teleop.assist.step import AssistState
from teleop.intent_types import BodyAngles, Hands, Mode
from teleop.pipeline import PipelineOutput

Wet = Mapping[str, tuple[float, float, float]]
"""Leaf -> share wet with water, nutrient and pesticide, as the 3-D view colours it."""


@dataclass(frozen=True, slots=True, eq=False)
class ConsoleView:
    """One painting. joint_rad, base: the robot in the 3-D view; moved: fruit there that no longer hangs where it grew.

    spine_xz_m: the operator on the floor map. targets: the three arms' set-points beside the operator's own angles in
    the arms panel. aimed: the fruit with the halo of pointing; picked: fruit and standing on the pick's card.
    """

    t_s: float
    mode: Mode
    spine_xz_m: tuple[float, float] | None
    hands: Hands
    angles: BodyAngles
    targets: Mapping[ArmName, ArmTarget | None]
    base: tuple[float, float, float]
    joint_rad: Mapping[str, float]
    moved: Mapping[str, tuple[float, ...]]
    spray_on: bool
    wet: Wet
    aimed: str | None = None
    picked: tuple[str, str] | None = None


def paint(output: PipelineOutput, assist: AssistState, robot: RobotState, wet: Wet, t_s: float) -> ConsoleView:
    """What the console shows after a frame."""
    command, task = output.command, assist.task
    return ConsoleView(
        t_s=t_s,
        mode=output.intent.mode,
        spine_xz_m=output.intent.spine_xz_m,
        hands=output.intent.hands,
        angles=output.intent.angles,
        targets={"right": command.right_arm, "left": command.left_arm, "rear": command.rear_arm},
        base=(robot.base_x_m, robot.base_y_m, robot.base_yaw_rad),
        joint_rad=robot.joint_rad,
        moved=robot.moved,
        spray_on=robot.spray_on,
        wet=wet,
        aimed=assist.aim.fruit,
        picked=None if task is None else (task.fruit, str(task.status)),
    )


Scenery = Mapping[str, Primitive]
"""Everything in the greenhouse by name, as the 3-D view draws it at the start."""
