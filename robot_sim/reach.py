"""Where a hand is for given servo angles: forward kinematics of one arm from the robot's own dimensions. Pure."""

from __future__ import annotations

from math import cos, sin

import numpy as np
import numpy.typing as npt

from robot_sim.arm_angles import forearm_direction, upper_arm_direction
from robot_sim.commands import ArmName, ArmTarget
from robot_sim.config import RobotConfig
from robot_sim.urdf_parts_arms import outward_sign, shoulder_pose

F64 = npt.NDArray[np.float64]


def hand_in_chest(arm: ArmName, target: ArmTarget, beyond_m: float, config: RobotConfig) -> F64:
    """(3,) point ``beyond_m`` past the flange of an arm, in chest axes [m].

    Chest axes: on the mast at the height of the shoulders, x where the chest faces, y left, z up. beyond_m: along the
    forearm; GRIP_M of robot_sim.urdf_parts_tools is the middle of the gripper's pads.
    """
    a = config.arm
    (x, y, _), (_, _, yaw) = shoulder_pose(arm, config)
    upper = np.array(upper_arm_direction(target.c1_deg, target.c2_deg))
    fore = np.array(forearm_direction(target))
    forward, outward, up = a.upper_m * upper + (a.forearm_m + beyond_m) * fore
    left = outward_sign(arm) * outward
    return np.array([x + cos(yaw) * forward - sin(yaw) * left, y + sin(yaw) * forward + cos(yaw) * left, up])


def hand_in_base(
    arm: ArmName, target: ArmTarget, beyond_m: float, lift_m: float, disc: float, config: RobotConfig
) -> F64:
    """The same point in the chassis' axes (x forward, y left, z over the floor) [m]; disc: its angle [rad]."""
    x, y, up = hand_in_chest(arm, target, beyond_m, config)
    yaw = config.body.chest_yaw_rad + disc
    height = config.body.shoulder_height_m + lift_m + up
    return np.array([cos(yaw) * x - sin(yaw) * y, sin(yaw) * x + cos(yaw) * y, height])
