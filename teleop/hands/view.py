"""What the images show round one tracked hand: the crop, and where hand, wrist and elbow lie in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from teleop.config.intent import HandConfig
from teleop.frames import ColorImage, DepthFrame
from teleop.hands.crop import color_at_depth, depth_pixel
from teleop.intent_types import Side
from teleop.skeleton import Skeleton


@dataclass(frozen=True, slots=True, eq=False)
class HandView:
    """Square crop of side ``crop_m`` at the hand, smaller at the image's edge.

    depth_m: (h, w) metres, 0 = no reading. color_rgb: (h, w, 3) or None. hand_px, wrist_px: (2,) column and row in
    the crop. z_m: depth of the hand joint. px_per_m: scale there. forearm_m: length of the forearm in space.
    ray_cos: cosine between forearm and the camera's ray, 1 when it points along it.
    """

    depth_m: npt.NDArray[np.float32]
    color_rgb: ColorImage | None
    hand_px: npt.NDArray[np.float64]
    wrist_px: npt.NDArray[np.float64]
    z_m: float
    px_per_m: float
    forearm_m: float
    ray_cos: float


def hand_view(frame: DepthFrame, skeleton: Skeleton, side: Side, config: HandConfig) -> HandView | None:
    """The view of one hand; None when arm joints are unknown or half of the crop lies outside the image."""
    elbow, wrist, hand = (skeleton.joint(f"{name}_{side}") for name in ("elbow", "wrist", "hand"))
    if elbow is None or wrist is None or hand is None:
        return None
    at, wrist_at = depth_pixel(hand, frame.camera), depth_pixel(wrist, frame.camera)
    forearm = wrist - elbow
    forearm_m = float(np.linalg.norm(forearm))
    if at is None or wrist_at is None or forearm_m < 0.05:
        return None
    rows, columns = frame.depth_mm.shape
    half = max(4, round(config.crop_m * at.px_per_m / 2))
    u0, v0 = max(0, round(at.u) - half), max(0, round(at.v) - half)
    u1, v1 = min(columns, round(at.u) + half + 1), min(rows, round(at.v) + half + 1)
    if (u1 - u0) * (v1 - v0) < 0.5 * (2 * half + 1) ** 2 or u1 <= u0 or v1 <= v0:
        return None
    color = color_at_depth(frame)
    return HandView(
        depth_m=(frame.depth_mm[v0:v1, u0:u1] * np.float32(1e-3)),
        color_rgb=None if color is None else np.ascontiguousarray(color[v0:v1, u0:u1]),
        hand_px=np.array([at.u - u0, at.v - v0]),
        wrist_px=np.array([wrist_at.u - u0, wrist_at.v - v0]),
        z_m=at.z_m,
        px_per_m=at.px_per_m,
        forearm_m=forearm_m,
        ray_cos=abs(float(forearm @ wrist)) / (forearm_m * float(np.linalg.norm(wrist))),
    )
