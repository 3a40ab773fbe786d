"""Which hands cannot be read, by geometry alone: what the joints and the depth image say, never the truth."""

from __future__ import annotations

from typing import Literal

import numpy as np

from teleop.config.intent import HandConfig
from teleop.frames import DepthFrame
from teleop.hands.aim import HandAim

Illegible = Literal["off_image", "along_ray", "too_few_pixels"]
"""off_image: the hand joint lies outside the image. along_ray: the forearm points along the ray, the palm hides
behind itself. too_few_pixels: of the hand's depth."""
_HAND_M = 0.09
"""Half a side of the square that a hand fills."""


def illegible(frame: DepthFrame, aim: HandAim, config: HandConfig) -> Illegible | None:
    """Why this hand cannot be read, or None."""
    rows, columns = frame.depth_mm.shape
    u, v = round(aim.u), round(aim.v)
    if not (0 <= u < columns and 0 <= v < rows):
        return "off_image"
    if aim.ray_cos > config.max_ray_cos:
        return "along_ray"
    r = max(2, round(_HAND_M * aim.px_per_m))
    near = frame.depth_mm[max(0, v - r) : min(rows, v + r + 1), max(0, u - r) : min(columns, u + r + 1)] * 1e-3
    if int(np.count_nonzero(np.abs(near - aim.z_m) < 1.5 * config.depth_gate_m)) < config.min_pixels:
        return "too_few_pixels"
    return None
