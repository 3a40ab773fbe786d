"""What the robot reports after each control period."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from robot_sim.commands import Liquid


@dataclass(frozen=True, slots=True)
class RobotState:
    """One snapshot. World frame: x along the row, y left, z up, metres and radians.

    joint_rad: URDF joint name -> position (rad, or m for prismatic joints).
    target_rad: URDF joint name -> limited set-point the motors are following.
    """

    sim_time_s: float
    base_x_m: float
    base_y_m: float
    base_yaw_rad: float
    drive_m_s: float
    turn_rad_s: float
    joint_rad: Mapping[str, float]
    target_rad: Mapping[str, float]
    gripper_open: bool
    cutter_closed: bool
    spray_on: bool
    liquid: Liquid
    estop: bool
    reasons: tuple[str, ...] = ()
    tank_l: Mapping[str, float] = field(default_factory=dict)
    """Liquid -> what is left in its tank [l]."""
    fruits: Mapping[str, str] = field(default_factory=dict)
    """Fruit that is not just hanging: name -> held, loose, boxed or dropped, with ``+damaged`` when it is bruised."""
    moved: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    """Scenery that is no longer where it was: primitive name -> x, y, z [m], quaternion x, y, z, w."""
