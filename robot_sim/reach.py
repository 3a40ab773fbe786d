"""Where a hand is for given servo angles, and the angles for a place: one arm, from the robot's dimensions. Pure."""

from __future__ import annotations

from math import cos, isnan, pi, sin, tau

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


def arm_for_hand(arm: ArmName, point_m: npt.ArrayLike, beyond_m: float, config: RobotConfig) -> ArmTarget | None:
    """The servo angles that bring the point ``beyond_m`` past the flange to a place (3,) in chest axes [m].

    The inverse of :func:`hand_in_chest`; None where no angles do, or where C2 would have to pass the shoulder. The
    elbow bends one way only, so there is one answer at most; whether it lies inside the joints' ranges is not asked.
    """
    c1, c2, bend = np.degrees(angles_for_hands(arm, np.asarray(point_m)[None], beyond_m, config)[0]).tolist()
    return None if isnan(bend) else ArmTarget(c1, c2, 180.0 - bend)


def angles_for_hands(arm: ArmName, points_m: F64, beyond_m: float, config: RobotConfig) -> F64:
    """The same for many places (N, 3): C1, C2 and the elbow's bend (N, 3) [rad], nan where there is no answer."""
    (x, y, _), (_, _, yaw) = shoulder_pose(arm, config)
    dx, dy, up = (points_m - (x, y, 0.0)).T
    forward = cos(yaw) * dx + sin(yaw) * dy
    outward = outward_sign(arm) * (cos(yaw) * dy - sin(yaw) * dx)
    a, b = config.arm.upper_m, config.arm.forearm_m + beyond_m
    with np.errstate(invalid="ignore"):
        # law of cosines in the plane of the bent arm
        bend = np.arccos((forward**2 + outward**2 + up**2 - a * a - b * b) / (2.0 * a * b))
        ahead, along = b * np.sin(bend), a + b * np.cos(bend)
        # C2 turns about the forward axis, so that what lies along the upper arm goes outward
        c2 = np.arcsin(np.where(along > np.abs(outward), outward / along, np.nan))
        c1 = np.arctan2(forward, -up) - np.arctan2(ahead, along * np.cos(c2))
    q = np.stack([np.remainder(c1 + pi, tau) - pi, c2, bend], axis=1)
    q[np.isnan(q).any(axis=1)] = np.nan
    return q
