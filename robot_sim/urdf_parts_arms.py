"""The three identical arms: shoulder C1, C2, upper arm, elbow, forearm; the frames hang down at zero.

Arm frame: x the way the arm faces, y left of that, z up. The right and left arm face forward and a little inwards
(toe-in), so that the planes in which they swing meet before the chest; the rear arm faces backwards and is a right arm
otherwise.
Joints are positive forward (C1), outward (C2) and bending forward (elbow): robot_sim.arm_angles.
"""

from __future__ import annotations

from math import pi

from robot_sim.commands import ArmName
from robot_sim.config import RobotConfig
from robot_sim.urdf_parts import ALONG_X, ALONG_Y, ZERO, Joint, Link, Vec3, box, cylinder
from robot_sim.urdf_parts_chassis import DISC_HEIGHT_M

FORWARD: Vec3 = (0.0, -1.0, 0.0)
"""Axis whose positive turn brings a hanging arm forward."""


def outward_sign(arm: ArmName) -> float:
    """+1 when outward is +y of the arm frame (left arm), -1 otherwise."""
    return 1.0 if arm == "left" else -1.0


def shoulder_pose(arm: ArmName, config: RobotConfig) -> tuple[Vec3, Vec3]:
    """Position [m] and roll-pitch-yaw [rad] of an arm frame in the disc frame."""
    a = config.arm
    if arm == "rear":
        return (-a.rear_offset_m, 0.0, DISC_HEIGHT_M), (0.0, 0.0, pi)
    side = outward_sign(arm)
    return (a.forward_offset_m, side * a.shoulder_offset_m, DISC_HEIGHT_M), (0.0, 0.0, -side * a.toe_in_rad)


def arm(name: ArmName, config: RobotConfig) -> list[Link | Joint]:
    """Links and joints of one arm without its tool; the tool goes on ``{name}_forearm`` at the flange."""
    a = config.arm
    xyz, rpy = shoulder_pose(name, config)
    s = outward_sign(name)
    shoulder = Link(
        f"{name}_shoulder",
        mass_kg=0.6,
        extent_m=(0.1, 0.08, 0.1),
        visuals=(
            cylinder(0.052, 0.050, (0.0, -0.004 * s, 0.0), "graphite", ALONG_Y),
            cylinder(0.036, 0.105, ZERO, "shell", ALONG_X),
            box(0.112, 0.030, 0.030, ZERO, "metal"),
        ),
        collisions=(cylinder(0.052, 0.07, ZERO, rpy=ALONG_Y),),
    )
    length = a.upper_m
    upper = Link(
        f"{name}_upper_arm",
        mass_kg=a.upper_kg,
        extent_m=(0.07, 0.07, length),
        com_m=(0.0, 0.0, -0.5 * length),
        visuals=(
            box(0.088, 0.060, 0.050, (0.0, 0.0, -0.035), "graphite"),
            cylinder(0.037, length - 0.13, (0.0, 0.0, -0.5 * length), "shell"),
            cylinder(0.039, 0.014, (0.0, 0.0, -0.075), "leaf"),
            box(0.052, 0.052, 0.030, (0.0, 0.0, -length + 0.055), "graphite"),
            # the elbow's fork and hub
            *(box(0.056, 0.014, 0.070, (0.0, k * 0.034, -length + 0.012), "graphite") for k in (1, -1)),
            cylinder(0.030, 0.090, (0.0, 0.0, -length), "metal", ALONG_Y),
        ),
        collisions=(cylinder(0.038, length, (0.0, 0.0, -0.5 * length)),),
    )
    reach = a.forearm_m
    forearm = Link(
        f"{name}_forearm",
        mass_kg=a.forearm_kg,
        extent_m=(0.055, 0.055, reach),
        com_m=(0.0, 0.0, -0.5 * reach),
        visuals=(
            cylinder(0.036, 0.050, ZERO, "shell", ALONG_Y),
            box(0.050, 0.044, 0.060, (0.0, 0.0, -0.045), "shell"),
            cylinder(0.028, reach - 0.10, (0.0, 0.0, -0.5 * reach - 0.02), "shell"),
            cylinder(0.031, 0.012, (0.0, 0.0, -0.085), "leaf"),
            box(0.054, 0.054, 0.024, (0.0, 0.0, -reach + 0.012), "graphite"),
        ),
        collisions=(cylinder(0.030, reach, (0.0, 0.0, -0.5 * reach)),),
    )
    c2_axis: Vec3 = (s, 0.0, 0.0)
    return [
        shoulder,
        Joint(f"{name}_c1", "disc_link", shoulder.name, xyz, rpy, FORWARD, "revolute", a.c1),
        upper,
        Joint(f"{name}_c2", shoulder.name, upper.name, axis=c2_axis, kind="revolute", limits=a.c2),
        forearm,
        Joint(f"{name}_elbow", upper.name, forearm.name, (0.0, 0.0, -length), ZERO, FORWARD, "revolute", a.elbow),
    ]
