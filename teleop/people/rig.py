"""The rig: 55 bones, their rest positions, and forward kinematics from bone rotations to joint positions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.joints import JOINT_INDEX, N_JOINTS

Floats = npt.NDArray[np.float64]

FINGERS: Final = ("thumb", "index", "middle", "ring", "little")
SIDES: Final = ("right", "left")


def _bones() -> tuple[tuple[str, str], ...]:
    rows = [("pelvis", ""), ("spine", "pelvis"), ("chest", "spine"), ("neck", "chest"), ("head", "neck")]
    for side in SIDES:
        chain = ("clavicle", "upper_arm", "upper_arm_twist", "forearm", "forearm_twist", "hand")
        parents = ("chest", *(f"{name}_{side}" for name in chain[:-1]))
        rows += [(f"{name}_{side}", parent) for name, parent in zip(chain, parents, strict=True)]
        for finger in FINGERS:
            rows.append((f"{finger}1_{side}", f"hand_{side}"))
            rows += [(f"{finger}{k}_{side}", f"{finger}{k - 1}_{side}") for k in (2, 3)]
        leg = ("thigh", "shin", "foot", "toes")
        parents = ("pelvis", *(f"{name}_{side}" for name in leg[:-1]))
        rows += [(f"{name}_{side}", parent) for name, parent in zip(leg, parents, strict=True)]
    return tuple(rows)


BONE_NAMES: Final = tuple(name for name, _ in _bones())
BONE: Final = {name: i for i, name in enumerate(BONE_NAMES)}
PARENT: Final = tuple(BONE.get(parent, -1) for _, parent in _bones())
N_BONES: Final = len(BONE_NAMES)


@dataclass(frozen=True, slots=True, eq=False)
class Rig:
    """Rest skeleton of one person.

    head_m: (55, 3) where each bone begins. skull_m, neck_base_m: (3,) points carried by head and chest.
    knuckles_m: (2, 3) middle of the four knuckles, right then left, carried by the hands.
    palm: (2, 3) unit normals out of the palms. finger_tip_m: (2, 5, 3) finger ends.
    """

    head_m: Floats
    skull_m: Floats
    neck_base_m: Floats
    knuckles_m: Floats
    palm: Floats
    finger_tip_m: Floats

    def bone(self, name: str) -> Floats:
        """Where a bone begins, (3,) metres."""
        return self.head_m[BONE[name]]


@dataclass(frozen=True, slots=True, eq=False)
class Posed:
    """Bone transforms of one pose: x' = R[b] (x - rig.head_m[b]) + p_m[b]; R (55, 3, 3), p_m (55, 3)."""

    R: Floats
    p_m: Floats

    def moved(self, R: Floats, t_m: Floats) -> Posed:
        """The same pose after a rigid motion x -> R x + t of the whole person."""
        return Posed(R @ self.R, self.p_m @ R.T + t_m)


def forward(rig: Rig, R: Floats) -> Posed:
    """Forward kinematics: world rotations (55, 3, 3) of all bones to transforms; the pelvis stays at rest."""
    p = np.empty((N_BONES, 3))
    for b, parent in enumerate(PARENT):
        p[b] = rig.head_m[b] if parent < 0 else p[parent] + R[parent] @ (rig.head_m[b] - rig.head_m[parent])
    return Posed(R, p)


def joints_m(rig: Rig, posed: Posed) -> Floats:
    """The 20 joints (20, 3) in metres as specification section 1 defines them."""
    out = np.empty((N_JOINTS, 3))

    def carried(bone: str, point: Floats) -> Floats:
        b = BONE[bone]
        return posed.R[b] @ (point - rig.head_m[b]) + posed.p_m[b]

    for i, side in enumerate(SIDES):
        for joint, bone in _JOINT_OF_BONE:
            out[JOINT_INDEX[f"{joint}_{side}"]] = posed.p_m[BONE[f"{bone}_{side}"]]
        out[JOINT_INDEX[f"hand_{side}"]] = carried(f"hand_{side}", rig.knuckles_m[i])
    hips = 0.5 * (out[JOINT_INDEX["hip_right"]] + out[JOINT_INDEX["hip_left"]])
    shoulders = 0.5 * (out[JOINT_INDEX["shoulder_right"]] + out[JOINT_INDEX["shoulder_left"]])
    out[JOINT_INDEX["hip_center"]] = hips + HIP_CENTER_L * (shoulders - hips)
    out[JOINT_INDEX["spine"]] = hips + SPINE_L * (shoulders - hips)
    out[JOINT_INDEX["shoulder_center"]] = carried("chest", rig.neck_base_m)
    out[JOINT_INDEX["head"]] = carried("head", rig.skull_m)
    return out


_JOINT_OF_BONE: Final = (
    ("shoulder", "upper_arm"),
    ("elbow", "forearm"),
    ("wrist", "hand"),
    ("hip", "thigh"),
    ("knee", "shin"),
    ("ankle", "foot"),
    ("foot", "toes"),
)
HIP_CENTER_L: Final = 0.20
SPINE_L: Final = 0.37
NECK_BASE_L: Final = 1.25
"""Trunk joints along mid-hips to mid-shoulders, in units of that length (specification, section 1)."""
CROWN_TO_SKULL_M: Final = 0.09


def neck_base_m(head_m: Floats) -> Floats:
    """The base of the neck (3,) at rest: 1.25 L from the hips' mid-point through the shoulders' mid-point."""
    hips = 0.5 * (head_m[BONE["thigh_right"]] + head_m[BONE["thigh_left"]])
    shoulders = 0.5 * (head_m[BONE["upper_arm_right"]] + head_m[BONE["upper_arm_left"]])
    return hips + NECK_BASE_L * (shoulders - hips)


def arms_in_trunk(rig: Rig, posed: Posed) -> bool:
    """Whether a hand, a wrist or the middle of a forearm lies inside the trunk, taken as an elliptic cylinder."""
    hips = 0.5 * (rig.bone("thigh_right") + rig.bone("thigh_left"))
    shoulders = 0.5 * (rig.bone("upper_arm_right") + rig.bone("upper_arm_left"))
    half = abs(float(rig.bone("upper_arm_right")[0] - shoulders[0]))
    points = []
    for i, side in enumerate(SIDES):
        elbow, hand = posed.p_m[BONE[f"forearm_{side}"]], BONE[f"hand_{side}"]
        wrist = posed.p_m[hand]
        knuckles = posed.R[hand] @ (rig.knuckles_m[i] - rig.head_m[hand]) + wrist
        points += [0.5 * (elbow + wrist), wrist, knuckles, 1.8 * knuckles - 0.8 * wrist]
    for name in ("pelvis", "chest"):
        b = BONE[name]
        rest = (np.stack(points) - posed.p_m[b]) @ posed.R[b] + rig.head_m[b]
        t = (rest - hips) @ (shoulders - hips) / ((shoulders - hips) @ (shoulders - hips))
        d = rest - (hips + t[:, None] * (shoulders - hips))
        level = (t > -0.15) & (t < 0.45) if name == "pelvis" else (t >= 0.35) & (t < 1.1)
        if bool((level & ((d[:, 0] / (0.80 * half)) ** 2 + (d[:, 2] / (0.62 * half)) ** 2 < 1.0)).any()):
            return True
    return False
