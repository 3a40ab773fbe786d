"""Where the robot's arms and disc are told to be now, as commands name it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from robot_sim.arm_angles import arm_target
from robot_sim.commands import ARM_NAMES, ArmName, ArmTarget
from robot_sim.state import RobotState


@dataclass(frozen=True, slots=True)
class Posture:
    """Limited set-points: of each arm in servo degrees, of the disc [rad]."""

    arms: Mapping[ArmName, ArmTarget]
    disc_rad: float


def posture(robot: RobotState) -> Posture:
    """The posture that the motors follow; between two commands it does not change."""
    return Posture({arm: arm_target(robot.target_rad, arm) for arm in ARM_NAMES}, robot.target_rad["disc"])
