"""The better hand rule: the hand's own pixels by depth and colour, cut at the wrist, judged by area.

Area is counted in square metres at the hand's depth, so it does not change with distance or resolution.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from teleop.config.intent import HandConfig
from teleop.frames import DepthFrame
from teleop.hands.crop import color_at_depth, depth_pixel
from teleop.hands.skin import skin_mask
from teleop.intent_types import Hand, Side
from teleop.joints import JOINT_INDEX
from teleop.skeleton import Skeleton


@dataclass(frozen=True, slots=True, eq=False)
class HandPixels:
    """The pixels of one hand. mask: (h, w) bool in the crop. px_per_m: scale at the hand's depth."""

    mask: npt.NDArray[np.bool_]
    px_per_m: float

    @property
    def area_m2(self) -> float:
        """Area that faces the camera."""
        return float(self.mask.sum()) / self.px_per_m**2


def hand_pixels(frame: DepthFrame, skeleton: Skeleton, side: Side, config: HandConfig) -> HandPixels | None:
    """Pixels near the hand in depth, beyond the wrist, skin-coloured where colour is registered; None if unseen."""
    hand, wrist = skeleton.joint(f"hand_{side}"), skeleton.joint(f"wrist_{side}")
    if hand is None or wrist is None:
        return None
    at = depth_pixel(hand, frame.camera)
    wrist_at = depth_pixel(wrist, frame.camera)
    if at is None or wrist_at is None:
        return None
    half = round(config.crop_m * at.px_per_m / 2)
    u0, v0 = max(0, round(at.u) - half), max(0, round(at.v) - half)
    u1, v1 = min(frame.depth_mm.shape[1], round(at.u) + half + 1), min(frame.depth_mm.shape[0], round(at.v) + half + 1)
    if u1 - u0 < half or v1 - v0 < half:
        return None
    depth_m = frame.depth_mm[v0:v1, u0:u1] * 1e-3
    gate = np.abs(depth_m - at.z_m) < config.depth_gate_m
    color = color_at_depth(frame)
    if color is not None:
        skin = skin_mask(np.ascontiguousarray(color[v0:v1, u0:u1]), config)
        # sleeves and walls go; a hand outside the skin range (glove, dim light) is left to its depth
        if (gate & skin).sum() >= 0.3 * gate.sum():
            gate &= skin
    uu, vv = np.meshgrid(np.arange(u0, u1), np.arange(v0, v1))
    axis_u, axis_v = at.u - wrist_at.u, at.v - wrist_at.v
    length = float(np.hypot(axis_u, axis_v))
    if length > 0.03 * at.px_per_m:
        gate &= ((uu - wrist_at.u) * axis_u + (vv - wrist_at.v) * axis_v) > 0
    count, labels = cv2.connectedComponents(gate.astype(np.uint8), connectivity=8)
    if count < 2:
        return None
    sizes = np.bincount(labels[gate], minlength=count)
    return HandPixels(labels == int(sizes.argmax()), at.px_per_m)


def forearm_ray_cos(skeleton: Skeleton, side: Side) -> float | None:
    """Cosine between the forearm and the camera's ray through the wrist: 1 when the hand hides behind itself."""
    elbow, wrist = skeleton.joint(f"elbow_{side}"), skeleton.joint(f"wrist_{side}")
    if elbow is None or wrist is None:
        return None
    forearm = wrist - elbow
    norm = float(np.linalg.norm(forearm) * np.linalg.norm(wrist))
    return abs(float(forearm @ wrist)) / norm if norm > 0 else None


def read_hand(frame: DepthFrame, skeleton: Skeleton, side: Side, config: HandConfig) -> tuple[Hand, float]:
    """OPEN, FIST or UNKNOWN with confidence 0..1."""
    if skeleton.confidence[JOINT_INDEX[f"hand_{side}"]] < config.min_confidence:
        return Hand.UNKNOWN, 0.0
    along = forearm_ray_cos(skeleton, side)
    if along is not None and along > config.max_ray_cos:
        return Hand.UNKNOWN, 0.0
    pixels = hand_pixels(frame, skeleton, side, config)
    if pixels is None or int(pixels.mask.sum()) < config.min_pixels:
        return Hand.UNKNOWN, 0.0
    score = (pixels.area_m2 - config.open_area_m2) / config.open_area_m2
    confidence = min(1.0, 0.5 + abs(score))
    return (Hand.OPEN if score > 0 else Hand.FIST), confidence
