"""Images from outside (PNG, JPEG), decoded only when their header claims a believable size.

A few bytes can claim to be an image of gigabytes; OpenCV would set the memory aside before it finds out.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import cv2
import numpy as np
import numpy.typing as npt

from teleop.sources.jpeg import MAX_SIDE, jpeg_size

_PNG: Final = b"\x89PNG\r\n\x1a\n"
_MAX_FILE_BYTES: Final = 256 << 20


def image_size(data: bytes) -> tuple[int, int] | None:
    """Width and height that the header of a PNG or JPEG claims, None for everything else."""
    if data[:8] == _PNG and len(data) >= 24 and data[12:16] == b"IHDR":
        return int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")
    return jpeg_size(data)


def decode_image(data: bytes, flags: int) -> npt.NDArray[Any] | None:
    """The image as ``cv2.imdecode`` gives it, or None: no PNG or JPEG, damaged, or over 8192 pixels a side."""
    size = image_size(data)
    if size is None or not (0 < size[0] <= MAX_SIDE and 0 < size[1] <= MAX_SIDE):
        return None
    try:
        return cv2.imdecode(np.frombuffer(data, dtype=np.uint8), flags)
    except cv2.error:
        return None


def read_image(path: Path, flags: int) -> npt.NDArray[Any] | None:
    """The image of a file, or None when it cannot be read as one."""
    try:
        with path.open("rb") as file:
            data = file.read(_MAX_FILE_BYTES)
    except OSError:
        return None
    return decode_image(data, flags)
