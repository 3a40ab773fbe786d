"""From the view of a hand to its own pixels, and to numbers that tell open from closed.

All lengths are counted in forearms of the same operator, so that neither distance, resolution nor size matters.
"""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from teleop.config.intent import HandConfig
from teleop.hands.skin import skin_mask
from teleop.hands.view import HandView

FEATURES: Final = (
    "area",
    "hull_area",
    "solidity",
    "length",
    "width",
    "roundness",
    "skin",
    "depth_spread",
    "ray_cos",
    "edges",
)


def hand_mask(view: HandView, config: HandConfig) -> npt.NDArray[np.bool_] | None:
    """Pixels (h, w) of the hand: near it in depth, beyond the wrist, in one piece; None when there are too few."""
    depth = view.depth_m
    v, u = np.mgrid[: depth.shape[0], : depth.shape[1]]
    du, dv = u - view.hand_px[0], v - view.hand_px[1]
    near = np.hypot(du, dv) < 0.03 * view.px_per_m
    core = depth[near & (np.abs(depth - view.z_m) < 2 * config.depth_gate_m)]
    if core.size == 0:
        return None
    gate = np.abs(depth - np.median(core)) < config.depth_gate_m
    axis = view.hand_px - view.wrist_px
    length = float(np.hypot(*axis))
    # seen from the fingers the wrist is no border: a hand that points at the sensor is not cut
    if length > 0.03 * view.px_per_m:
        gate &= ((u - view.wrist_px[0]) * axis[0] + (v - view.wrist_px[1]) * axis[1]) > 0.3 * length * length
    _, labels = cv2.connectedComponents(gate.astype(np.uint8), connectivity=8)
    sizes = np.bincount(labels[near & gate], minlength=1)
    sizes[0] = 0
    if sizes.max() == 0:
        return None
    mask: npt.NDArray[np.bool_] = np.asarray(labels == int(sizes.argmax()))
    return mask if int(mask.sum()) >= config.min_pixels else None


def features(view: HandView, mask: npt.NDArray[np.bool_], config: HandConfig) -> npt.NDArray[np.float64]:
    """The numbers named in FEATURES; ``skin`` and ``edges`` are 0 without colour."""
    px = view.px_per_m * view.forearm_m
    area_px = float(mask.sum())
    outlines, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    outline = max(outlines, key=cv2.contourArea)
    hull = cv2.convexHull(outline)
    # a contour runs through pixel centres: add the half pixel outside it
    hull_px = cv2.contourArea(hull) + 0.5 * cv2.arcLength(hull, True) + 1.0
    v, u = np.nonzero(mask)
    axis = view.hand_px - view.wrist_px
    axis = axis / max(1e-6, float(np.hypot(*axis)))
    along = (u - view.wrist_px[0]) * axis[0] + (v - view.wrist_px[1]) * axis[1]
    across = -(u - view.wrist_px[0]) * axis[1] + (v - view.wrist_px[1]) * axis[0]
    skin = edges = 0.0
    if view.color_rgb is not None:
        skin = float(skin_mask(view.color_rgb, config)[mask].mean())
        grey = cv2.cvtColor(view.color_rgb, cv2.COLOR_RGB2GRAY).astype(np.float32)
        inner = cv2.erode(mask.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)
        if inner.any():
            gx, gy = cv2.Sobel(grey, cv2.CV_32F, 1, 0), cv2.Sobel(grey, cv2.CV_32F, 0, 1)
            edges = float(np.hypot(gx, gy)[inner].mean() / (grey[inner].mean() + 10.0))
    return np.array(
        [
            area_px / px**2,
            hull_px / px**2,
            min(1.0, area_px / hull_px),
            float(np.percentile(along, 97)) / px,
            float(np.percentile(across, 97) - np.percentile(across, 3)) / px,
            area_px / max(1.0, cv2.arcLength(outline, True)) ** 2 * 4 * np.pi,
            skin,
            float(np.std(view.depth_m[mask])) / config.depth_gate_m,
            view.ray_cos,
            edges,
        ]
    )
