"""Poses as directions of limbs, and how they turn the rig's bones."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np

from teleop.people.rig import BONE, FINGERS, N_BONES, SIDES, Floats, Posed, Rig, forward

DOWN: Final = (0.0, -1.0, 0.0)
FORWARD: Final = (0.0, 0.0, -1.0)
_MCP_PIP_DIP_RAD: Final = (1.48, 1.75, 1.25)
"""Flexion of the three finger segments in a tight fist."""
_THUMB_RAD: Final = (0.60, 0.80, 0.90)


@dataclass(frozen=True, slots=True, eq=False)
class ArmPose:
    """One arm. upper, fore: directions (3,) shoulder to elbow, elbow to wrist.

    palm: the way the palm faces, or None: then pronation_rad (0 thumb towards the bend, +pi/2 palm down).
    hand: direction of the hand, None = along the forearm. curl: 0 flat .. 1 fist. spread_rad: between fingers.
    """

    upper: Floats
    fore: Floats
    palm: Floats | None = None
    pronation_rad: float = 0.5
    hand: Floats | None = None
    curl: float = 0.25
    spread_rad: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class LegPose:
    """One leg. thigh, shin: directions (3,); toes: the way the foot points."""

    thigh: Floats = field(default_factory=lambda: np.array(DOWN))
    shin: Floats = field(default_factory=lambda: np.array(DOWN))
    toes: Floats = field(default_factory=lambda: np.array(FORWARD))


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """A whole body: rotations (3, 3) of pelvis, chest and head from rest; right then left arm and leg."""

    arms: tuple[ArmPose, ArmPose]
    legs: tuple[LegPose, LegPose]
    pelvis: Floats = field(default_factory=lambda: np.eye(3))
    chest: Floats = field(default_factory=lambda: np.eye(3))
    head: Floats = field(default_factory=lambda: np.eye(3))


def rotation(axis: Floats, angle_rad: float) -> Floats:
    """Rotation matrix (3, 3) about an axis (Rodrigues)."""
    x, y, z = axis / np.linalg.norm(axis)
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle_rad) * K + (1.0 - np.cos(angle_rad)) * (K @ K)


def yaw(angle_rad: float) -> Floats:
    """Turn about the vertical; positive turns the operator's front towards their left."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def unit(v: Floats) -> Floats:
    """v / |v|."""
    return v / np.sqrt(v @ v)


def swing(a: Floats, b: Floats) -> Floats:
    """Smallest rotation (3, 3) that takes unit vector a to unit vector b."""
    v, c = np.cross(a, b), float(a @ b)
    if c < -0.9999:
        return rotation(np.cross(a, (1.0, 0.0, 0.0) if abs(a[0]) < 0.9 else (0.0, 1.0, 0.0)), np.pi)
    K = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    return np.eye(3) + K + K @ K / (1.0 + c)


def between(A: Floats, B: Floats, t: float) -> Floats:
    """Rotation at fraction t from A to B (along the geodesic)."""
    D = A.T @ B
    angle = float(np.arccos(np.clip((np.trace(D) - 1.0) / 2.0, -1.0, 1.0)))
    axis = np.array([D[2, 1] - D[1, 2], D[0, 2] - D[2, 0], D[1, 0] - D[0, 1]])
    if angle < 1e-6 or float(axis @ axis) < 1e-12:
        return A
    return A @ rotation(axis, t * angle)


def _frame(d: Floats, side: Floats) -> Floats:
    """Orthonormal columns: d, side made orthogonal to d, their cross product."""
    d = unit(d)
    s = unit(side - (side @ d) * d)
    return np.stack([d, s, np.cross(d, s)], axis=1)


def _hinge(first: Floats, second: Floats, fallback: Floats) -> Floats:
    """Axis of the elbow or knee: first x second where it bends visibly, the fallback where it is straight."""
    bent = np.cross(first, second)
    sine = float(np.sqrt(bent @ bent))
    w = min(1.0, max(0.0, (sine - 0.08) / 0.3))
    axis = fallback if sine < 0.08 else w * bent / sine + (1.0 - w) * fallback
    axis = axis - (axis @ first) * first
    return unit(axis) if axis @ axis > 1e-6 else unit(np.cross(first, (0.3, 0.2, 0.9)))


def _arm(rig: Rig, R: Floats, arm: ArmPose, i: int) -> None:
    side, sign = SIDES[i], 1.0 - 2.0 * i
    chest = R[BONE["chest"]]
    u, f = unit(arm.upper), unit(arm.fore)
    shoulder, elbow = rig.bone(f"upper_arm_{side}"), rig.bone(f"forearm_{side}")
    wrist, knuckles = rig.bone(f"hand_{side}"), rig.knuckles_m[i]
    u0, f0 = unit(elbow - shoulder), unit(wrist - elbow)
    h0 = np.cross(u0, (0.0, 0.0, -1.0))
    # The collar bone lifts with the arm (scapulohumeral rhythm: about a third of the elevation above 30 degrees).
    raised = float(np.clip(np.arcsin(np.clip((chest.T @ u)[1], -1, 1)) + 0.9, 0.0, 2.2))
    clavicle = chest @ rotation(np.array([0.0, 0.0, 1.0]), sign * 0.22 * raised)
    reach = clavicle @ swing(u0, clavicle.T @ u)
    h = _hinge(u, f, reach @ h0)
    upper = _frame(u, h) @ _frame(u0, h0).T
    fore = _frame(f, h) @ _frame(f0, h0).T
    if arm.palm is None:
        palm = rotation(f, -sign * arm.pronation_rad) @ (-sign * h)
    else:
        palm = arm.palm
    d = f if arm.hand is None else unit(arm.hand)
    palm = palm if abs(unit(palm) @ d) < 0.98 else -sign * h + 0.1 * palm
    hand = _frame(d, palm) @ _frame(unit(knuckles - wrist), rig.palm[i]).T
    R[BONE[f"clavicle_{side}"]] = clavicle
    R[BONE[f"upper_arm_{side}"]] = between(reach, upper, 0.5)
    R[BONE[f"upper_arm_twist_{side}"]] = upper
    R[BONE[f"forearm_{side}"]] = fore
    R[BONE[f"forearm_twist_{side}"]] = swing_twist(fore, hand, f)
    R[BONE[f"hand_{side}"]] = hand
    _fingers(rig, R, arm, i)


def swing_twist(fore: Floats, hand: Floats, axis: Floats) -> Floats:
    """The forearm's lower half: the forearm turned about its own axis by 60 % of the hand's twist."""
    D = hand @ fore.T
    v = np.array([D[2, 1] - D[1, 2], D[0, 2] - D[2, 0], D[1, 0] - D[0, 1]])
    angle = float(np.arctan2(v @ axis, np.trace(D) - 1.0))
    return rotation(axis, 0.6 * angle) @ fore


def _fingers(rig: Rig, R: Floats, arm: ArmPose, i: int) -> None:
    side = SIDES[i]
    hand, palm = R[BONE[f"hand_{side}"]], rig.palm[i]
    along = unit(rig.knuckles_m[i] - rig.bone(f"hand_{side}"))
    across = unit(np.cross(along, palm))
    for k, finger in enumerate(FINGERS):
        if finger == "thumb":
            base = rig.bone(f"thumb1_{side}")
            tip = unit(rig.finger_tip_m[i, 0] - base)
            axis = unit(np.cross(tip, unit(rig.knuckles_m[i] - base) + 0.55 * palm))
            angles = _THUMB_RAD
        else:
            axis, angles = across, _MCP_PIP_DIP_RAD
        turn = hand @ rotation(palm, (k - 2.5) * arm.spread_rad * (1.0 - arm.curl) * (1.0 if i == 0 else -1.0))
        for segment in range(3):
            turn = turn @ rotation(axis, arm.curl * angles[segment])
            R[BONE[f"{finger}{segment + 1}_{side}"]] = turn


def _leg(rig: Rig, R: Floats, leg: LegPose, i: int) -> None:
    side = SIDES[i]
    t, s, toes = unit(leg.thigh), unit(leg.shin), unit(leg.toes)
    hip, knee, ankle = (rig.bone(f"{b}_{side}") for b in ("thigh", "shin", "foot"))
    t0, s0 = unit(knee - hip), unit(ankle - knee)
    back0 = np.array([0.0, 0.0, 1.0])
    h = _hinge(t, s, unit(np.cross(t, -toes)) if abs(t @ toes) < 0.95 else np.array([-1.0, 0.0, 0.0]))
    R[BONE[f"thigh_{side}"]] = _frame(t, h) @ _frame(t0, np.cross(t0, back0)).T
    R[BONE[f"shin_{side}"]] = _frame(s, h) @ _frame(s0, np.cross(s0, back0)).T
    up = -s if abs(s @ toes) < 0.9 else -t
    foot = _frame(toes, up) @ _frame(np.array(FORWARD), -np.array(DOWN)).T
    R[BONE[f"foot_{side}"]] = foot
    R[BONE[f"toes_{side}"]] = foot


def pose_rig(rig: Rig, pose: Pose) -> Posed:
    """Bone transforms of a pose; the pelvis stays where it rests."""
    R = np.empty((N_BONES, 3, 3))
    R[BONE["pelvis"]], R[BONE["chest"]], R[BONE["head"]] = pose.pelvis, pose.chest, pose.head
    R[BONE["spine"]] = between(pose.pelvis, pose.chest, 0.5)
    R[BONE["neck"]] = between(pose.chest, pose.head, 0.5)
    for i in range(2):
        _arm(rig, R, pose.arms[i], i)
        _leg(rig, R, pose.legs[i], i)
    return forward(rig, R)
