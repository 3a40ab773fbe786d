"""Arm angles: between the source's servo degrees and the joints of the URDF, and where the upper arm points.

Order of axes, the same for all three arms: C1 is fixed to the torso and turns about its lateral axis; C2 is
carried by C1 and turns about the arm's own forward axis; the elbow is carried by the upper arm and is parallel to
C1 while C2 is zero.  Arm axes: f forward (the way the arm faces), o outward, u up::

    direction of the upper arm = R_C1(c1) R_C2(c2) (0, 0, -1)
        f = cos(c2) sin(c1)        o = sin(c2)        u = -cos(c2) cos(c1)

so c1 is exactly theta2 of the source (eq. 18, projection on the sagittal plane), and c2 is the elevation out of
that plane; theta1 (eq. 17) is atan(tan(c2) / cos(c1)) and equals c2 only while c1 is zero.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import asin, atan2, cos, degrees, hypot, radians, sin

from robot_sim.commands import ArmName, ArmTarget

ARM_AXES = ("c1", "c2", "elbow")
"""Joints of one arm from the shoulder on; the URDF names them ``right_c1`` and so on."""


def arm_joint_names(arm: ArmName) -> tuple[str, str, str]:
    """URDF joint names of one arm, from the shoulder on."""
    return (f"{arm}_c1", f"{arm}_c2", f"{arm}_elbow")


def joint_rad(target: ArmTarget, arm: ArmName) -> dict[str, float]:
    """URDF joint positions [rad] of one arm's servo angles; the elbow joint is zero when the arm is straight."""
    names = arm_joint_names(arm)
    return dict(
        zip(names, (radians(target.c1_deg), radians(target.c2_deg), radians(180.0 - target.elbow_deg)), strict=True)
    )


def arm_target(joints_rad: Mapping[str, float], arm: ArmName) -> ArmTarget:
    """Servo angles of one arm's URDF joint positions [rad]; the inverse of :func:`joint_rad`."""
    c1, c2, elbow = (joints_rad[name] for name in arm_joint_names(arm))
    return ArmTarget(degrees(c1), degrees(c2), 180.0 - degrees(elbow))


def upper_arm_direction(c1_deg: float, c2_deg: float) -> tuple[float, float, float]:
    """Unit vector (forward, outward, up) from shoulder to elbow."""
    c1, c2 = radians(c1_deg), radians(c2_deg)
    return (cos(c2) * sin(c1), sin(c2), -cos(c2) * cos(c1))


def forearm_direction(target: ArmTarget) -> tuple[float, float, float]:
    """Unit vector (forward, outward, up) from elbow to wrist; a bent elbow brings the forearm forward at c1 = 0."""
    c1, c2, bend = radians(target.c1_deg), radians(target.c2_deg), radians(180.0 - target.elbow_deg)
    # R_C1(c1) R_C2(c2) applied to (sin bend, 0, -cos bend)
    return (
        cos(c1) * sin(bend) + sin(c1) * cos(c2) * cos(bend),
        sin(c2) * cos(bend),
        sin(c1) * sin(bend) - cos(c1) * cos(c2) * cos(bend),
    )


def shoulder_from_direction(forward: float, outward: float, up: float, held_c1_deg: float = 0.0) -> tuple[float, float]:
    """(c1_deg, c2_deg) that point the upper arm along a direction; the inverse of :func:`upper_arm_direction`.

    The vector need not be a unit vector. c2 is in -90..90. An arm straight out to the side (or a zero vector)
    leaves c1 free: it stays at ``held_c1_deg``.
    """
    sagittal = hypot(forward, up)
    length = hypot(sagittal, outward)
    if length == 0.0:
        return held_c1_deg, 0.0
    c2_deg = degrees(asin(max(-1.0, min(1.0, outward / length))))
    if sagittal < 1e-9 * length:
        return held_c1_deg, c2_deg
    return degrees(atan2(forward, -up)), c2_deg
