"""Skin colour in YCbCr (source eq. 22, 23)."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from teleop.config.intent import HandConfig
from teleop.frames import ColorImage


def skin_mask(color_rgb: ColorImage, config: HandConfig) -> npt.NDArray[np.bool_]:
    """Pixels (H, W) whose Cb and Cr lie in the skin range."""
    # OpenCV orders the channels Y, Cr, Cb
    ycrcb = cv2.cvtColor(color_rgb, cv2.COLOR_RGB2YCrCb)
    cr, cb = ycrcb[..., 1], ycrcb[..., 2]
    return (cb >= config.cb_min) & (cb <= config.cb_max) & (cr >= config.cr_min) & (cr <= config.cr_max)


def cleaned(mask: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Morphological clean-up: opening removes specks, closing fills pinholes (3x3 each)."""
    kernel = np.ones((3, 3), np.uint8)
    opened = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, kernel)
    return cv2.morphologyEx(opened, cv2.MORPH_CLOSE, kernel).astype(bool)
