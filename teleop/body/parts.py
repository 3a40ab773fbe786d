"""Body parts the forest tells apart: the 20 joints' regions first, then the limb and chest pieces between them."""

from __future__ import annotations

from typing import Final

from teleop.joints import JOINT_NAMES, MIRROR_JOINT

FILLER_NAMES: Final[tuple[str, ...]] = (
    "upper_arm_right",
    "forearm_right",
    "thigh_right",
    "shin_right",
    "chest_right",
    "upper_arm_left",
    "forearm_left",
    "thigh_left",
    "shin_left",
    "chest_left",
)
PART_NAMES: Final[tuple[str, ...]] = JOINT_NAMES + FILLER_NAMES
"""Index < 20: the region round that joint (same index as in JOINT_NAMES); from 20 on: what lies between."""
N_PARTS: Final = len(PART_NAMES)
NO_PART: Final = 255
"""Label of every pixel that is not the person."""

MIRROR_PART: Final[tuple[int, ...]] = (
    *MIRROR_JOINT,
    *((len(JOINT_NAMES) + (i + 5) % 10) for i in range(len(FILLER_NAMES))),
)
"""Index of the same part on the other side of the body."""
