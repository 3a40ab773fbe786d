"""The robot's URDF, generated from its configuration: the one description for physics, console and recordings."""

from __future__ import annotations

from robot_sim.commands import ARM_NAMES
from robot_sim.config import RobotConfig
from robot_sim.derived import derived
from robot_sim.urdf_parts import Joint, Link, robot_xml
from robot_sim.urdf_parts_arms import arm
from robot_sim.urdf_parts_body import head, upper_body
from robot_sim.urdf_parts_chassis import chassis, lift
from robot_sim.urdf_parts_tools import fruit_box, gripper, sprayer


def robot_parts(config: RobotConfig) -> list[Link | Joint]:
    """All links and joints, from the floor up."""
    parts = [*chassis(config), *lift(config), *upper_body(config)]
    for name in ARM_NAMES:
        parts += arm(name, config)
    return [*parts, *gripper(config), *fruit_box(config), *sprayer(config), *head(config)]


@derived
def robot_urdf(config: RobotConfig) -> str:
    """URDF text of the three-arm robot; boxes, cylinders and spheres only, no mesh files."""
    return robot_xml("greenhouse_robot", robot_parts(config))
