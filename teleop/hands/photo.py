"""A hand in a colour picture without depth, cut out by its box: the same question for a photograph."""

from __future__ import annotations

import math
from typing import Final

import cv2
import numpy as np

from teleop.config.intent import HandConfig
from teleop.frames import ColorImage
from teleop.hands.network import load_networks
from teleop.hands.patch import SIZE, Patch, color_layers
from teleop.hands.skin_model import chroma, fit_skin, generic_skin
from teleop.intent_types import Hand

BOX: Final = 0.9
"""Share of the patch's side that the box's longer side takes."""


def photo_patch(box_rgb: ColorImage, config: HandConfig) -> Patch:
    """Brightness and skin (SIZE, SIZE, 2) float32 of a box (H, W, 3) round a hand; the skin is that of its middle."""
    height, width = box_rgb.shape[:2]
    longest = max(height, width)
    size = (max(1, round(BOX * SIZE * width / longest)), max(1, round(BOX * SIZE * height / longest)))
    small = cv2.resize(box_rgb, size, interpolation=cv2.INTER_AREA)
    left, top = (SIZE - size[0]) // 2, (SIZE - size[1]) // 2
    border = (top, SIZE - size[1] - top, left, SIZE - size[0] - left)
    patch = cv2.copyMakeBorder(small, *border, borderType=cv2.BORDER_REPLICATE).astype(np.uint8)
    middle = np.zeros((SIZE, SIZE), bool)
    middle[SIZE * 3 // 8 : SIZE * 3 // 4, SIZE * 3 // 8 : SIZE * 5 // 8] = True
    skin = fit_skin(chroma(patch)[middle], config) or generic_skin(config)
    return color_layers(patch, skin, middle)


def read_photo(box_rgb: ColorImage, config: HandConfig) -> tuple[Hand, float]:
    """OPEN, FIST or UNKNOWN with confidence 0..1, of a box (H, W, 3) RGB round one hand."""
    logit = float(load_networks()["color"].logit(photo_patch(box_rgb, config)[None])[0])
    if abs(logit) < config.decide_margin:
        return Hand.UNKNOWN, 0.0
    return (Hand.OPEN if logit > 0 else Hand.FIST), 1.0 / (1.0 + math.exp(-abs(logit)))
