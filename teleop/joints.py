"""The 20 joints, in the source's order (spec/teleoperation, section 1). "Right" is the operator's right."""

from __future__ import annotations

from typing import Final

JOINT_NAMES: Final[tuple[str, ...]] = (
    "head",
    "shoulder_center",
    "shoulder_right",
    "elbow_right",
    "spine",
    "wrist_right",
    "hand_right",
    "hip_right",
    "knee_right",
    "ankle_right",
    "foot_right",
    "foot_left",
    "ankle_left",
    "knee_left",
    "hand_left",
    "wrist_left",
    "hip_left",
    "hip_center",
    "elbow_left",
    "shoulder_left",
)
JOINT_INDEX: Final[dict[str, int]] = {name: i for i, name in enumerate(JOINT_NAMES)}
N_JOINTS: Final = len(JOINT_NAMES)


def _mirror(name: str) -> str:
    if name.endswith("_right"):
        return name.removesuffix("_right") + "_left"
    if name.endswith("_left"):
        return name.removesuffix("_left") + "_right"
    return name


MIRROR_JOINT: Final[tuple[int, ...]] = tuple(JOINT_INDEX[_mirror(name)] for name in JOINT_NAMES)
"""Index of the same joint on the other side of the body."""

BONES: Final[tuple[tuple[int, int], ...]] = tuple(
    (JOINT_INDEX[a], JOINT_INDEX[b])
    for a, b in (
        ("head", "shoulder_center"),
        ("shoulder_center", "spine"),
        ("spine", "hip_center"),
        *(
            (f"{a}{side}" if a not in ("shoulder_center", "hip_center") else a, f"{b}{side}")
            for side in ("_right", "_left")
            for a, b in (
                ("shoulder_center", "shoulder"),
                ("shoulder", "elbow"),
                ("elbow", "wrist"),
                ("wrist", "hand"),
                ("hip_center", "hip"),
                ("hip", "knee"),
                ("knee", "ankle"),
                ("ankle", "foot"),
            )
        ),
    )
)
"""Pairs of joint indices that are drawn as lines and whose length is constant."""
