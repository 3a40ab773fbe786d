"""JPEG images: made from RGB, and those from outside decoded only when their header claims a believable size."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import cv2
import numpy as np

from teleop.errors import FrameError
from teleop.frames import ColorImage, DepthFrame

MAX_SIDE: Final = 8192
_FRAME_HEADERS: Final = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""Start-of-frame markers (ITU-T T.81, table B.1)."""


def jpeg_size(data: bytes) -> tuple[int, int] | None:
    """Width and height from the frame header, or None when there is none."""
    if data[:2] != b"\xff\xd8":
        return None
    position = 2
    while position + 9 <= len(data) and data[position] == 0xFF:
        marker = data[position + 1]
        if marker in _FRAME_HEADERS:
            height = int.from_bytes(data[position + 5 : position + 7], "big")
            return int.from_bytes(data[position + 7 : position + 9], "big"), height
        position += 2 + int.from_bytes(data[position + 2 : position + 4], "big")
    return None


def decode_jpeg(data: bytes) -> ColorImage | None:
    """RGB (h, w, 3), or None when the bytes are no JPEG, damaged, or larger than 8192 pixels a side."""
    size = jpeg_size(data)
    if size is None or not (0 < size[0] <= MAX_SIDE and 0 < size[1] <= MAX_SIDE):
        return None
    image = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), cv2.IMREAD_COLOR)
    return None if image is None else cv2.cvtColor(image, cv2.COLOR_BGR2RGB).astype(np.uint8, copy=False)


def encode_jpeg(image: ColorImage, quality: int) -> bytes:
    """RGB (h, w, 3) uint8 as JPEG of the given quality, 1..100. Raises FrameError."""
    ok, jpeg = cv2.imencode(".jpg", cv2.cvtColor(image, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, quality])
    if not ok:
        raise FrameError(f"colour image of shape {image.shape} cannot be written as JPEG")
    return jpeg.tobytes()


def through_jpeg(frame: DepthFrame, quality: int = 90) -> DepthFrame:
    """The frame as a recording will give it back, so that what is computed from it can be computed again."""
    if frame.color_rgb is None or frame.color_jpeg is not None:
        return frame
    jpeg = encode_jpeg(frame.color_rgb, quality)
    return replace(frame, color_rgb=decode_jpeg(jpeg), color_jpeg=jpeg)
