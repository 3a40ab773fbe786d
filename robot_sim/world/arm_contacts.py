"""Which parts of the robot touch each other: arm against arm, arm against trunk and chassis."""

from __future__ import annotations

from itertools import product

from robot_sim.world.body import RobotBody
from robot_sim.world.client import Client

_RIGHT = ("right_upper_arm", "right_forearm", "right_tool", "gripper_left_link", "gripper_right_link")
_LEFT = ("left_upper_arm", "left_forearm", "left_tool", "left_box")
_REAR = ("rear_upper_arm", "rear_forearm", "rear_tool")
_TRUNK = ("disc_link",)
PAIRS: tuple[tuple[str, str], ...] = (
    *product(_RIGHT, _LEFT),
    *product((*_RIGHT[1:], *_LEFT[1:]), _REAR),
    # upper arms begin beside the trunk
    *product((*_RIGHT[1:], *_LEFT[1:], *_REAR[1:]), _TRUNK),
)
"""The physics lets them pass through each other, so that a contact is seen and not just felt."""


def touching(client: Client, robot: RobotBody) -> frozenset[tuple[str, str]]:
    """The pairs of links that overlap now."""
    return frozenset(
        (a, b) for a, b in PAIRS if client.getClosestPoints(robot.id, robot.id, 0.0, robot.links[a], robot.links[b])
    )
