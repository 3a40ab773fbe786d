"""Which body part each piece of skin belongs to: by bone and fraction along the limb, at rest."""

from __future__ import annotations

from typing import Final

import numpy as np

from teleop.body.parts import PART_NAMES
from teleop.people.body import Bytes, Floats32, Ints32
from teleop.people.rig import BONE, FINGERS, HIP_CENTER_L, SIDES, SPINE_L, Floats, Rig

_PART: Final = {name: i for i, name in enumerate(PART_NAMES)}
_LIMBS: Final = (
    # bones, from, to, (limit of fraction, part) ... in order
    (("upper_arm", "upper_arm_twist"), "upper_arm", "forearm", ((0.30, "shoulder"), (0.75, "upper_arm"), (9, "elbow"))),
    (("forearm", "forearm_twist"), "forearm", "hand", ((0.25, "elbow"), (0.78, "forearm"), (9, "wrist"))),
    (("thigh",), "thigh", "shin", ((0.28, "hip"), (0.77, "thigh"), (9, "knee"))),
    (("shin",), "shin", "foot", ((0.23, "knee"), (0.80, "shin"), (9, "ankle"))),
    (("foot",), "foot", "toes", ((0.35, "ankle"), (9, "foot"))),
)


def _fraction(points: Floats, a: Floats, b: Floats) -> Floats:
    d = b - a
    return (points - a) @ d / (d @ d)


def face_parts(rig: Rig, vertices_m: Floats32, faces: Ints32, vertex_bone: Ints32) -> Bytes:
    """Part (F,) uint8 of each face, from the face's centre and the bone that most of its corners follow."""
    centre = vertices_m.astype(np.float64)[faces].mean(axis=1)
    corner = vertex_bone[faces]
    bone = np.where(corner[:, 1] == corner[:, 2], corner[:, 1], corner[:, 0])
    part = np.full(len(faces), _PART["head"], np.uint8)
    part[bone == BONE["neck"]] = _PART["shoulder_center"]
    _torso(rig, centre, bone, part)
    for i, side in enumerate(SIDES):
        for bones, start, end, regions in _LIMBS:
            mine = np.isin(bone, [BONE[f"{b}_{side}"] for b in bones])
            t = _fraction(centre, rig.bone(f"{start}_{side}"), rig.bone(f"{end}_{side}"))
            for limit, name in reversed(regions):
                part[mine & (t <= limit)] = _PART[f"{name}_{side}"]
        hand = np.isin(bone, [BONE[f"{finger}{k}_{side}"] for finger in FINGERS for k in (1, 2, 3)])
        palm = bone == BONE[f"hand_{side}"]
        t = _fraction(centre, rig.bone(f"hand_{side}"), rig.knuckles_m[i])
        part[palm & (t < 0.3)] = _PART[f"wrist_{side}"]
        part[hand | (palm & (t >= 0.3))] = _PART[f"hand_{side}"]
        part[bone == BONE[f"toes_{side}"]] = _PART[f"foot_{side}"]
    return part


def _torso(rig: Rig, centre: Floats, bone: Ints32, part: Bytes) -> None:
    hips = 0.5 * (rig.bone("thigh_right") + rig.bone("thigh_left"))
    shoulders = 0.5 * (rig.bone("upper_arm_right") + rig.bone("upper_arm_left"))
    s = _fraction(centre, hips, shoulders)
    torso = np.isin(bone, [BONE[b] for b in ("pelvis", "spine", "chest", "clavicle_right", "clavicle_left")])
    x = centre[:, 0]
    middle = 0.5 * (HIP_CENTER_L + SPINE_L)
    part[torso & (s < middle)] = _PART["hip_center"]
    part[torso & (s >= middle) & (s < 0.60)] = _PART["spine"]
    chest = torso & (s >= 0.60) & (s < 1.0)
    part[torso & (s >= 1.0)] = _PART["shoulder_center"]
    for side, sign in (("right", 1.0), ("left", -1.0)):
        hip, shoulder = rig.bone(f"thigh_{side}"), rig.bone(f"upper_arm_{side}")
        out = sign * x
        part[torso & (s < 0.10) & (out > 0.45 * sign * hip[0])] = _PART[f"hip_{side}"]
        part[chest & (out >= 0)] = _PART[f"chest_{side}"]
        part[torso & (s > 0.75) & (out > 0.74 * sign * shoulder[0])] = _PART[f"shoulder_{side}"]
