"""Where one hand is in the depth image, and how the forearm leads to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from teleop.frames import Camera
from teleop.hands.crop import depth_pixel
from teleop.intent_types import Side
from teleop.skeleton import Skeleton

_SHORTEST_FOREARM_M = 0.05
_SHORTEST_PROJECTION_M = 0.05
"""A forearm that looks shorter than this in the image has no direction there; the hand's own takes its place."""


@dataclass(frozen=True, slots=True, eq=False)
class HandAim:
    """u, v: the hand joint's column and row. z_m: its depth. px_per_m: scale there. direction: (2,) unit, the way
    from elbow to hand in the image (columns, rows). ray_cos: cosine between forearm and the camera's ray, 1 when it
    points along it. flipped: the thumb is on the other side than that of a right hand in an unmirrored image."""

    u: float
    v: float
    z_m: float
    px_per_m: float
    direction: npt.NDArray[np.float64]
    ray_cos: float
    flipped: bool


def aim_at_hand(skeleton: Skeleton, side: Side, camera: Camera) -> HandAim | None:
    """Aim at one hand; None when the arm's joints are unknown or behind the camera."""
    elbow, wrist, hand = (skeleton.joint(f"{name}_{side}") for name in ("elbow", "wrist", "hand"))
    if elbow is None or wrist is None or hand is None:
        return None
    at, wrist_at, elbow_at = (depth_pixel(point, camera) for point in (hand, wrist, elbow))
    forearm = wrist - elbow
    length_m = float(np.linalg.norm(forearm))
    if at is None or wrist_at is None or elbow_at is None or length_m < _SHORTEST_FOREARM_M:
        return None
    direction = np.array([0.0, -1.0])
    for start in (elbow_at, wrist_at):
        d = np.array([at.u - start.u, at.v - start.v])
        if float(np.hypot(*d)) > _SHORTEST_PROJECTION_M * at.px_per_m:
            direction = d / float(np.hypot(*d))
            break
    ray_cos = abs(float(forearm @ wrist)) / (length_m * float(np.linalg.norm(wrist)))
    return HandAim(at.u, at.v, at.z_m, at.px_per_m, direction, ray_cos, (side == "left") != camera.mirrored)
