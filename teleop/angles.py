"""Angles of arms and legs from a skeleton: source eq. (8)-(21).

All are unsigned, as the source's arc cosine gives them, in degrees, None where there is no answer.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from teleop.config.intent import AngleConfig
from teleop.intent_types import ArmAngles, BodyAngles, Side
from teleop.skeleton import Skeleton

Vector = npt.NDArray[np.float64]

XY = (0, 1)
YZ = (1, 2)
DOWN: Vector = np.array([0.0, -1.0, 0.0])
"""K0 of eq. (17), (18): the arm hanging down."""


def angle_deg(a: Vector, b: Vector) -> float | None:
    """Angle between two vectors of any dimension, 0..180 degrees; None when one has no length."""
    norm = float(np.linalg.norm(a) * np.linalg.norm(b))
    if not norm > 0.0:
        return None
    return math.degrees(math.acos(min(1.0, max(-1.0, float(a @ b) / norm))))


def projected_angle_deg(a: Vector, b: Vector, plane: tuple[int, int], config: AngleConfig) -> float | None:
    """Angle between the projections of two bones (3,) on a coordinate plane.

    None when a bone, or its projection as a part of it, is too short to have a direction.
    """
    axes = list(plane)
    for bone in (a, b):
        length = float(np.linalg.norm(bone))
        if length < config.min_bone_m or float(np.linalg.norm(bone[axes])) < config.min_projection * length:
            return None
    return angle_deg(a[axes], b[axes])


def arm_angles(skeleton: Skeleton, side: Side, config: AngleConfig) -> ArmAngles:
    """theta1, theta2 (shoulder) and theta3 (elbow) of one arm."""
    shoulder, elbow, wrist = (skeleton.joint(f"{name}_{side}") for name in ("shoulder", "elbow", "wrist"))
    theta1 = theta2 = theta3 = None
    if shoulder is not None and elbow is not None:
        b0 = elbow - shoulder  # (14)
        theta1 = projected_angle_deg(b0, DOWN, XY, config)  # (15), (17)
        theta2 = projected_angle_deg(b0, DOWN, YZ, config)  # (16), (18)
        if wrist is not None:
            b3, b4 = shoulder - elbow, wrist - elbow  # (19), (20)
            if min(np.linalg.norm(b3), np.linalg.norm(b4)) >= config.min_bone_m:
                theta3 = angle_deg(b3, b4)  # (21)
    return ArmAngles(theta1, theta2, theta3)


def leg_angles(skeleton: Skeleton, config: AngleConfig) -> tuple[float | None, float | None]:
    """T1 (8) and T2 (11): angle of right hip -> knee and left hip -> knee in x-y (9, 10) and in y-z (12, 13)."""
    hip_r, knee_r, hip_l, knee_l = (skeleton.joint(n) for n in ("hip_right", "knee_right", "hip_left", "knee_left"))
    if hip_r is None or knee_r is None or hip_l is None or knee_l is None:
        return None, None
    right, left = knee_r - hip_r, knee_l - hip_l
    return projected_angle_deg(right, left, XY, config), projected_angle_deg(right, left, YZ, config)


def body_angles(skeleton: Skeleton, config: AngleConfig) -> BodyAngles:
    """All angles of a skeleton, in whatever axes it is given (levelled, unless ``level: off``)."""
    T1, T2 = leg_angles(skeleton, config)
    return BodyAngles(arm_angles(skeleton, "right", config), arm_angles(skeleton, "left", config), T1, T2)


NO_ANGLES = BodyAngles(ArmAngles(None, None, None), ArmAngles(None, None, None), None, None)
