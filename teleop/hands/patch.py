"""One hand as a small picture that looks alike for every operator, distance, camera and arm: what the network sees.

Turned so that the forearm comes from below, scaled by depth, mirrored to a right hand; four layers: relief (depth
against the hand's), where there is no depth, brightness against the hand's, and likeness to the operator's skin.
"""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from teleop.config.intent import HandConfig
from teleop.frames import ColorImage, DepthFrame
from teleop.hands.aim import HandAim
from teleop.hands.crop import color_at_depth
from teleop.hands.skin_model import SkinModel, chroma, likelihood

Patch = npt.NDArray[np.float32]
SIZE: Final = 40
"""Pixels along a side; a finger is two of them wide."""
SIDE_M: Final = 0.30
AHEAD_M: Final = 0.025
"""The knuckles lie this far below the patch's middle: an open hand reaches further ahead than the wrist behind."""
RELIEF_M: Final = 0.10
LAYERS: Final = ("relief", "no_depth", "brightness", "skin")
BRIGHTNESS: Final = LAYERS.index("brightness")
DEPTH_LAYERS: Final = (0, 1)
COLOR_LAYERS: Final = (2, 3)
_CORE_M: Final = 0.04
_MIDDLE: Final = slice(SIZE // 2 - 3, SIZE // 2 + 9)


def hand_depth_m(frame: DepthFrame, aim: HandAim, config: HandConfig) -> float | None:
    """Depth of the hand's surface: the median near the joint, which must lie in the image; None when nothing there has
    the joint's depth."""
    r = max(2, round(_CORE_M * aim.px_per_m))
    u, v = round(aim.u), round(aim.v)
    rows, columns = frame.depth_mm.shape
    near = frame.depth_mm[max(0, v - r) : min(rows, v + r + 1), max(0, u - r) : min(columns, u + r + 1)] * 1e-3
    core = near[np.abs(near - aim.z_m) < 1.5 * config.depth_gate_m]
    return float(np.median(core)) if core.size >= 4 else None


def rectifier(aim: HandAim, side_m: float = SIDE_M, ahead_m: float = AHEAD_M) -> npt.NDArray[np.float64]:
    """Affine map (2, 3) from patch pixels to image pixels (columns, rows)."""
    step_px = side_m * aim.px_per_m / SIZE
    up = aim.direction
    across = np.array([-up[1], up[0]]) * (-1.0 if aim.flipped else 1.0)
    middle = np.array([aim.u, aim.v]) + ahead_m * aim.px_per_m * up
    A = np.stack([step_px * across, -step_px * up], axis=1)
    return np.concatenate([A, (middle - A @ np.full(2, (SIZE - 1) / 2))[:, None]], axis=1)


def relief_layers(frame: DepthFrame, aim: HandAim, z_m: float, side_m: float, ahead_m: float, relief_m: float) -> Patch:
    """Depth against ``z_m`` over ``relief_m``, clipped to -1..1, and where none is read: (SIZE, SIZE, 2) float32."""
    M = rectifier(aim, side_m, ahead_m)
    flags = cv2.INTER_NEAREST | cv2.WARP_INVERSE_MAP
    depth_m = cv2.warpAffine(frame.depth_mm, M, (SIZE, SIZE), flags=flags, borderValue=0).astype(np.float32) * 1e-3
    missing = depth_m == 0.0
    relief = np.where(missing, 1.0, np.clip((depth_m - z_m) / relief_m, -1.0, 1.0))
    return np.stack([relief, missing], axis=2).astype(np.float32)


def color_layers(patch_rgb: ColorImage, skin: SkinModel, on_hand: npt.NDArray[np.bool_]) -> Patch:
    """Brightness and skin (SIZE, SIZE, 2) of a rectified colour patch; on_hand: pixels that set the brightness."""
    grey = cv2.cvtColor(patch_rgb, cv2.COLOR_RGB2GRAY).astype(np.float32)
    level = float(np.median(grey[on_hand])) if on_hand.any() else float(np.median(grey))
    bright = np.clip((grey - level) / (0.45 * level + 12.0), -1.5, 1.5)
    return np.stack([bright, likelihood(skin, chroma(patch_rgb))], axis=2).astype(np.float32)


def hand_patch(frame: DepthFrame, aim: HandAim, z_m: float, skin: SkinModel) -> Patch:
    """Layers (SIZE, SIZE, 4) float32; brightness and skin are 0 when the frame has no colour registered to depth.

    z_m: depth of the hand's surface (``hand_depth_m``). What lies off the image has no depth and no brightness.
    """
    out = np.zeros((SIZE, SIZE, 4), np.float32)
    out[..., :2] = relief_layers(frame, aim, z_m, SIDE_M, AHEAD_M, RELIEF_M)
    color = color_at_depth(frame)
    if color is not None:
        M, size = rectifier(aim), (SIZE, SIZE)
        # shrink as areas do: a camera with more pixels than the patch must not give noisier patches
        step = SIDE_M * aim.px_per_m / SIZE
        linear = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
        if step > 1.5:
            rgb = _smooth_warp(color, M)
        else:
            rgb = cv2.warpAffine(color, M, size, flags=linear, borderMode=cv2.BORDER_REPLICATE).astype(np.uint8)
        on_hand = (np.abs(out[..., 0]) < 0.6) & (out[..., 1] == 0.0)
        on_hand[: _MIDDLE.start], on_hand[_MIDDLE.stop :] = False, False
        on_hand[:, : _MIDDLE.start], on_hand[:, _MIDDLE.stop :] = False, False
        out[..., 2:] = color_layers(rgb, skin, on_hand)
    return out


def _smooth_warp(color: ColorImage, M: npt.NDArray[np.float64]) -> ColorImage:
    """The warp at twice the size, then halved by areas; only the neighbourhood of the hand is touched."""
    double = M.copy()
    double[:, :2] /= 2
    double[:, 2] = M[:, 2] - 0.5 * double[:, :2] @ np.ones(2)
    linear = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    wide = cv2.warpAffine(color, double, (2 * SIZE, 2 * SIZE), flags=linear, borderMode=cv2.BORDER_REPLICATE)
    return cv2.resize(wide, (SIZE, SIZE), interpolation=cv2.INTER_AREA).astype(np.uint8)
