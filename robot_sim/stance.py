"""Where the upper body stands: chassis on the floor, lift and disc above it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, sin

import numpy as np
import numpy.typing as npt

from robot_sim.config import RobotConfig
from robot_sim.kinematics.transforms import FloatArray, inverse_pose, rot_z
from robot_sim.state import RobotState
from robot_sim.urdf_parts_chassis import DISC_HEIGHT_M


@dataclass(frozen=True, slots=True)
class Stance:
    """Chassis in the world [m, rad], height of the lift [m], angle of the disc [rad]."""

    x_m: float
    y_m: float
    yaw_rad: float
    lift_m: float
    disc_rad: float

    def T_world_disc(self, config: RobotConfig) -> FloatArray:
        """Pose (4, 4) of the disc's axes: x where the chest faces, y left, z up, on the disc's top."""
        T = rot_z(self.yaw_rad + config.body.chest_yaw_rad + self.disc_rad)
        T[:3, 3] = (self.x_m, self.y_m, config.body.shoulder_height_m - DISC_HEIGHT_M + self.lift_m)
        return T

    def to_disc(self, point_m: npt.ArrayLike, config: RobotConfig) -> FloatArray:
        """World points (3,) or (N, 3) in the disc's axes."""
        T = inverse_pose(self.T_world_disc(config))
        return np.asarray(np.asarray(point_m) @ T[:3, :3].T + T[:3, 3])

    def to_world(self, point_m: npt.ArrayLike, config: RobotConfig) -> FloatArray:
        """Points (3,) or (N, 3) of the disc's axes in the world."""
        T = self.T_world_disc(config)
        return np.asarray(np.asarray(point_m) @ T[:3, :3].T + T[:3, 3])

    def driven(self, forward_m: float) -> Stance:
        """After driving straight on."""
        return replace(self, x_m=self.x_m + forward_m * cos(self.yaw_rad), y_m=self.y_m + forward_m * sin(self.yaw_rad))


def stance_of(state: RobotState) -> Stance:
    """Where a robot stands by its own report."""
    return Stance(state.base_x_m, state.base_y_m, state.base_yaw_rad, state.joint_rad["lift"], state.joint_rad["disc"])
