"""The operator's own skin colour: learned from the face, remembered over frames.

Cb and Cr as a normal distribution. A face is small, half hidden by hair or a mask, and lit like the hands: the mean
is a trimmed one of what lies near the middle of plausible skin, the spread has a floor, and frames are averaged.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from teleop.config.intent import HandConfig
from teleop.frames import ColorImage, DepthFrame
from teleop.hands.crop import color_at_depth, depth_pixel
from teleop.skeleton import Skeleton

_FACE_DOWN_M = 0.03
_FACE_RADIUS_M = 0.07
_FACE_DEPTH_M = 0.15
"""The face is round the head joint (centre of the skull), a little below it and up to this much in front of it."""
_FEWEST_PIXELS = 25
_MARGIN = 12.0
"""How far beyond the source's skin range a face may be: coloured light shifts it."""
_FLOOR_VARIANCE = 9.0
_LEAST_COLOR = 5.0
"""Skin is at least this far from grey (Cb = Cr = 128); hair and masks are often not."""


@dataclass(frozen=True, slots=True)
class SkinModel:
    """mean: (Cb, Cr). covariance: (Cb Cb, Cb Cr, Cr Cr). weight: frames it was learned from, saturating."""

    mean: tuple[float, float]
    covariance: tuple[float, float, float]
    weight: float = 0.0


def generic_skin(config: HandConfig) -> SkinModel:
    """The middle of the source's ranges (22), (23), as wide as they are."""
    mean = (0.5 * (config.cb_min + config.cb_max), 0.5 * (config.cr_min + config.cr_max))
    spread = (config.cb_max - config.cb_min) / 4, (config.cr_max - config.cr_min) / 4
    return SkinModel(mean, (spread[0] ** 2, -0.5 * spread[0] * spread[1], spread[1] ** 2))


def stored_skin(config: HandConfig) -> SkinModel | None:
    """The skin of the operator's profile, as sure as one learned over all ``skin_frames``; None without one."""
    if config.skin is None:
        return None
    cb, cr, a, b, c = config.skin
    return SkinModel((cb, cr), (a, b, c), float(config.skin_frames))


def chroma(color_rgb: ColorImage) -> npt.NDArray[np.float32]:
    """Cb and Cr, (..., 2) float32, of an RGB image (H, W, 3)."""
    return cv2.cvtColor(color_rgb, cv2.COLOR_RGB2YCrCb)[..., :0:-1].astype(np.float32)


def likelihood(model: SkinModel, cb_cr: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """How much pixels (..., 2) look like this skin, 1 at its mean: exp(-d^2 / 4), d the Mahalanobis distance."""
    a, b, c = model.covariance
    det = a * c - b * b
    x, y = cb_cr[..., 0] - model.mean[0], cb_cr[..., 1] - model.mean[1]
    distance2 = (c * x * x - 2 * b * x * y + a * y * y) / det
    return np.exp(np.float32(-0.25) * distance2.astype(np.float32))


def fit_skin(cb_cr: npt.NDArray[np.float32], config: HandConfig) -> SkinModel | None:
    """Skin of pixels (N, 2) that are mostly a face; None when too few of them can be skin."""
    low = np.array([config.cb_min - _MARGIN, config.cr_min - _MARGIN])
    high = np.array([config.cb_max + _MARGIN, config.cr_max + _MARGIN])
    pixels = cb_cr[((cb_cr >= low) & (cb_cr <= high)).all(axis=1)]
    for _ in range(2):
        if len(pixels) < _FEWEST_PIXELS:
            return None
        off = np.abs(pixels - np.median(pixels, axis=0))
        spread = np.maximum(1.4826 * np.median(off, axis=0), np.sqrt(_FLOOR_VARIANCE))
        pixels = pixels[(off < 2.5 * spread).all(axis=1)]
    if len(pixels) < _FEWEST_PIXELS:
        return None
    mean, cov = pixels.mean(axis=0), np.cov(pixels.T) + _FLOOR_VARIANCE * np.eye(2)
    if float(np.hypot(*(mean - 128.0))) < _LEAST_COLOR:
        return None
    return SkinModel(
        (float(mean[0]), float(mean[1])), (float(cov[0, 0]), float(cov[0, 1]), float(cov[1, 1])), weight=1.0
    )


def face_skin(frame: DepthFrame, skeleton: Skeleton, config: HandConfig) -> SkinModel | None:
    """The skin of the operator's face in this frame; None without colour, head or enough plausible pixels."""
    color, head = color_at_depth(frame), skeleton.joint("head")
    if color is None or head is None:
        return None
    at = depth_pixel(head - np.array([0.0, _FACE_DOWN_M, 0.0]), frame.camera)
    if at is None:
        return None
    r = max(2, round(_FACE_RADIUS_M * at.px_per_m))
    u, v = round(at.u), round(at.v)
    rows, columns = frame.depth_mm.shape
    window = (slice(max(0, v - r), min(rows, v + r + 1)), slice(max(0, u - r), min(columns, u + r + 1)))
    depth_m = frame.depth_mm[window] * 1e-3
    if depth_m.size == 0:
        return None
    on_face = (depth_m > at.z_m - _FACE_DEPTH_M) & (depth_m < at.z_m + 0.05)
    return fit_skin(chroma(np.ascontiguousarray(color[window]))[on_face], config)


def remembered(memory: SkinModel | None, seen: SkinModel | None, config: HandConfig) -> SkinModel | None:
    """The running mean over ``skin_frames`` frames. A face far from what is remembered counts little: it is hidden."""
    if seen is None or memory is None:
        return memory if seen is None else seen
    weight = min(memory.weight + 1.0, config.skin_frames)
    off = float(likelihood(memory, np.array([seen.mean], np.float32))[0])
    share = (0.1 + 0.9 * off) / weight
    mean = tuple(m + share * (s - m) for m, s in zip(memory.mean, seen.mean, strict=True))
    covariance = tuple(m + share * (s - m) for m, s in zip(memory.covariance, seen.covariance, strict=True))
    return SkinModel(mean, covariance, weight)  # type: ignore[arg-type]


def step_skin(
    memory: SkinModel | None, frame: DepthFrame, skeleton: Skeleton | None, config: HandConfig
) -> SkinModel | None:
    """The operator's skin after this frame; begins with the profile's where there is one."""
    if config.hand == "paper":
        return None
    seen = None if skeleton is None else face_skin(frame, skeleton, config)
    return remembered(memory or stored_skin(config), seen, config)
