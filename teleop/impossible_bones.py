"""Joints at the end of a bone that nobody has: too long or too short for a person, or for this operator."""

from __future__ import annotations

from typing import Final

import numpy as np

from teleop.config.intent import BoneConfig
from teleop.joints import JOINT_INDEX, JOINT_NAMES
from teleop.skeleton import Skeleton

_LIMBS: Final = (
    ("upper_arm", "shoulder", "elbow", ("elbow", "wrist", "hand")),
    ("forearm", "elbow", "wrist", ("wrist", "hand")),
    ("thigh", "hip", "knee", ("knee", "ankle", "foot")),
    ("shin", "knee", "ankle", ("ankle", "foot")),
)


def _bones() -> tuple[tuple[str, int, int, tuple[int, ...]], ...]:
    everything = tuple(range(len(JOINT_NAMES)))
    rows = [("trunk_m", JOINT_INDEX["hip_center"], JOINT_INDEX["shoulder_center"], everything)]
    for side in ("right", "left"):
        for bone, a, b, hanging in _LIMBS:
            ends = (JOINT_INDEX[f"{a}_{side}"], JOINT_INDEX[f"{b}_{side}"])
            rows.append((f"{bone}_m", *ends, tuple(JOINT_INDEX[f"{name}_{side}"] for name in hanging)))
    return tuple(rows)


_BONES: Final = _bones()
"""Name of the expected length, the two ends, and the joints that hang on it."""


def without_impossible_bones(skeleton: Skeleton, config: BoneConfig) -> tuple[Skeleton, bool]:
    """The skeleton with every joint unknown that hangs on an impossible bone, and whether there was one.

    A bone is impossible when its length is off the expected one by more than ``tolerance`` of it; without a possible
    trunk nothing is believed.
    """
    joints = skeleton.joints_m
    lost: list[int] = []
    for bone, a, b, hanging in _BONES:
        expected_m = getattr(config, bone)
        # a joint that is not known makes the length NaN: nothing is said then
        if abs(float(np.linalg.norm(joints[a] - joints[b])) - expected_m) > config.tolerance * expected_m:
            lost += hanging
    if not lost:
        return skeleton, False
    joints, confidence = joints.copy(), skeleton.confidence.copy()
    joints[lost], confidence[lost] = np.nan, 0.0
    return Skeleton(skeleton.t_ns, joints, confidence), True
