"""Where the robot stands to pick a fruit by hand, in the operator's steps."""

from __future__ import annotations

from robot_sim.commands import ArmTarget
from robot_sim.config import RobotConfig
from robot_sim.plants import Fruit
from robot_sim.reach import hand_in_base
from robot_sim.urdf_parts_tools import GRIP_M

PICK_POSE = ArmTarget(45.0, 0.0, 135.0)
"""The right arm round a fruit, in the operator's steps: upper arm half raised, forearm level."""


def standing_place(fruit: Fruit, config: RobotConfig) -> tuple[float, float]:
    """x of the robot and height of its lift [m] from which the pick pose reaches a fruit of the left row."""
    x, _, z = hand_in_base("right", PICK_POSE, GRIP_M, 0.0, 0.0, config)
    lift = fruit.xyz_m[2] + fruit.top_m - config.pick.grip_under_top_m - float(z)
    limits = config.body.lift
    return fruit.xyz_m[0] - float(x), min(max(lift, limits.lower), limits.upper)
