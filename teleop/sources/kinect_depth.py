"""Kinect v1 raw disparity (11 bit) and millimetres.

The sensor compares each speckle with its reference image of a plane at ``z0``. With base line ``b``, and pixel
pitch ``p`` on that plane, a shift of ``d`` pixels means ``z = z0 b / (b - d p)``, and raw counts quarter pixels:
``d = (raw - 800) / 4 - 3/8`` (PrimeSense's nominal constants, those of an uncalibrated device).
Together ``z = K / (raw_0 - raw)`` with K = 342.2 m and raw_0 = 1086.7; steps of z^2 / K, 12 mm at 2 m.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from teleop.frames import DepthImage

RAW_NONE = 2047
MAX_MM = 10_000
_REFERENCE_PLANE_MM = 1200.0
_BASELINE_MM = 75.0
_PITCH_MM = 1.052
_K_MM = _REFERENCE_PLANE_MM * _BASELINE_MM * 4.0 / _PITCH_MM
_RAW_0 = 800.0 + 4.0 * (_BASELINE_MM / _PITCH_MM + 0.375)


def _table() -> DepthImage:
    raw = np.arange(2048, dtype=np.float64)
    mm = np.where(raw < _RAW_0 - 1.0, _K_MM / np.maximum(_RAW_0 - raw, 1.0), 0.0)
    mm[(mm > MAX_MM) | (raw == RAW_NONE)] = 0.0
    return np.rint(mm).astype(np.uint16)


RAW_TO_MM = _table()
"""(2048,) uint16: millimetres of each raw count, 0 for no reading."""


def raw_to_mm(raw: npt.NDArray[np.uint16]) -> DepthImage:
    """(H, W) raw counts to millimetres; 0 = no reading."""
    return RAW_TO_MM[np.minimum(raw, RAW_NONE)]


def mm_to_raw(depth_mm: DepthImage) -> npt.NDArray[np.uint16]:
    """(H, W) millimetres to the nearest raw count; what the sensor cannot express is 2047, no reading."""
    depth: npt.NDArray[Any] = depth_mm.astype(np.float64)
    with np.errstate(divide="ignore"):
        raw = np.rint(_RAW_0 - _K_MM / depth)
    usable = (depth_mm > 0) & (raw >= 0) & (depth_mm <= MAX_MM)
    return np.where(usable, raw, RAW_NONE).astype(np.uint16)
