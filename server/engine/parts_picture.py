"""The forest's answer as a picture: the likeliest body part of every pixel it was asked about, in its own colour."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from server.images_wire import ImageKind, ImagePacket
from teleop.body.parts import PART_NAMES
from teleop.skeleton import BodyParts

_HUES: Final = {"right": 18, "left": 104, "": 52}
"""OpenCV hues (degrees / 2): orange, blue and green between them, told apart with any kind of colour vision."""
_SPREAD: Final = 11
_ALPHA: Final = 205


def _palette() -> npt.NDArray[np.uint8]:
    """(P, 4) BGRA. A side has one family of hues; neighbours along a limb differ in lightness."""
    hsv = np.zeros((1, len(PART_NAMES), 3), np.uint8)
    seen = dict.fromkeys(_HUES, 0)
    for i, name in enumerate(PART_NAMES):
        side = next((side for side in ("right", "left") if name.endswith(side)), "")
        k = seen[side]
        seen[side] += 1
        hsv[0, i] = (_HUES[side] + (k * 5) % (2 * _SPREAD) - _SPREAD, (240, 165, 110)[k % 3], (250, 165, 215)[k % 3])
    bgr = cv2.cvtColor(hsv, cv2.COLOR_HSV2BGR)[0]
    return np.concatenate([bgr, np.full((len(PART_NAMES), 1), _ALPHA, np.uint8)], axis=1)


PALETTE: Final = _palette()


def parts_picture(parts: BodyParts | None, width: int, height: int) -> npt.NDArray[np.uint8]:
    """(h, w, 4) BGRA, one pixel per pixel that the forest saw of a depth image of the given size; clear elsewhere."""
    stride = parts.stride if parts is not None else 4
    picture = np.zeros((-(-height // stride), -(-width // stride), 4), np.uint8)
    if parts is not None and len(parts.u):
        picture[parts.v // stride, parts.u // stride] = PALETTE[parts.probability.argmax(axis=1)]
    return picture


def parts_packet(parts: BodyParts | None, width: int, height: int, seq: int) -> ImagePacket:
    """The picture as PNG: JPEG has no clear pixels and smears the borders."""
    picture = parts_picture(parts, width, height)
    ok, data = cv2.imencode(".png", picture, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    if not ok:
        raise ValueError(f"cannot encode a picture of shape {picture.shape}")
    return ImagePacket(ImageKind.PARTS, picture.shape[1], picture.shape[0], seq, data.tobytes())
