"""Metric crops of the operator: depth sampled in cells of a fixed size in metres, whatever camera and distance.

The same functions serve training and run time. Images are canonical (see ``teleop.body.features``). A cell is the mean
of four samples of the nearest pixels, so a crop costs the same at every resolution and has no holes far away.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.features import FAR_MM, Pixels, PixelTuple

EMPTY: Final = 1.5
"""What a cell without a pixel of the operator reads, in the crop's units of depth."""


@dataclass(frozen=True, slots=True)
class CropShape:
    """rows, columns: cells. cell_m: side of a cell at the crop's depth. unit_m: relative depth that reads as 1.
    near, far: relative depths are cut there, in units."""

    rows: int
    columns: int
    cell_m: float
    unit_m: float
    near: float
    far: float

    def tuple(self) -> tuple[int, int, float, float, float, float]:
        """The fields, for compiled functions."""
        return self.rows, self.columns, self.cell_m, self.unit_m, self.near, self.far


WHOLE: Final = CropShape(112, 96, 0.0225, 0.5, -2.0, 1.0)
"""The operator: 2.52 m high, 2.16 m wide."""
LOCAL: Final = CropShape(32, 32, 0.0125, 0.25, -1.5, 1.5)
"""Round one joint: 0.4 m wide."""

_WORKING_FOCAL_PX: Final = 285.0
Shape = tuple[int, int, float, float, float, float]


@nb.njit(cache=True, nogil=True)
def _medians(
    flat_mm: npt.NDArray[np.int16], first: int, width: int, height: int, step: int
) -> tuple[float, float, float]:
    columns, rows = np.zeros(width, np.int64), np.zeros(height, np.int64)
    depths = np.zeros(FAR_MM // 8 + 1, np.int64)
    for r in range(0, height, step):
        for c in range(0, width, step):
            z = flat_mm[first + r * width + c]
            if z < FAR_MM:
                columns[c] += 1
                rows[r] += 1
                depths[z // 8] += 1
    half = columns.sum() // 2
    column = np.searchsorted(np.cumsum(columns), half, side="right")
    row = np.searchsorted(np.cumsum(rows), half, side="right")
    depth = np.searchsorted(np.cumsum(depths), half, side="right")
    return float(column), float(row), (depth * 8 + 4) * 1e-3


def body_centre(image: Pixels) -> tuple[float, float, float]:
    """Median column, row and depth in m of the operator's pixels; large images are thinned."""
    step = max(1, round(float(image.intrinsics[0]) / _WORKING_FOCAL_PX))
    centre: tuple[float, float, float] = _medians(image.flat_mm, image.first, image.width, image.height, step)
    return centre


@nb.njit(cache=True, nogil=True)
def _indices(centre: float, pixels_a_cell: float, cells: int, mirror: bool, length: int) -> npt.NDArray[np.int32]:
    """Pixel (2 * cells,) under each half cell along one axis, -1 outside the image."""
    out = np.empty(2 * cells, np.int32)
    for k in range(2 * cells):
        at = (0.5 * k + 0.25 - 0.5 * cells) * pixels_a_cell
        pixel = int(np.floor(centre + (-at if mirror else at) + 0.5))
        out[k] = pixel if 0 <= pixel < length else -1
    return out


@nb.njit(cache=True, nogil=True)
def sample_crop(
    flat_mm: npt.NDArray[np.int16],
    first: int,
    width: int,
    height: int,
    centre: tuple[float, float, float],
    focal_px: tuple[float, float],
    mirror: bool,
    shape: Shape,
    out: npt.NDArray[np.float32],
) -> None:
    """Fill a crop (rows, columns, 2): mean depth of each cell relative to the centre's, and the share of it covered.

    centre: column, row and depth [m] of the crop's middle in the image that begins at ``first``; mirror turns the crop
    about that column.
    """
    rows, columns, cell_m, unit_m, near, far = shape
    column, row, depth_m = centre
    us = _indices(column, focal_px[0] * cell_m / depth_m, columns, mirror, width)
    vs = _indices(row, focal_px[1] * cell_m / depth_m, rows, False, height)
    scale, zero = np.float32(1e-3 / unit_m), np.float32(depth_m / unit_m)
    low, high = np.float32(near), np.float32(far)
    for y in range(rows):
        for x in range(columns):
            total, count = np.int32(0), np.int32(0)
            for v in (vs[2 * y], vs[2 * y + 1]):
                if v < 0:
                    continue
                line = first + v * width
                for u in (us[2 * x], us[2 * x + 1]):
                    if u >= 0:
                        z = np.int32(flat_mm[line + u])
                        if z < FAR_MM:
                            total += z
                            count += 1
            if count > 0:
                out[y, x, 0] = min(max(np.float32(total) / np.float32(count) * scale - zero, low), high)
            else:
                out[y, x, 0] = EMPTY
            out[y, x, 1] = np.float32(0.25) * np.float32(count)


@nb.njit(cache=True, nogil=True)
def joint_crops(
    image: PixelTuple, joints_m: npt.NDArray[np.float64], mirror: npt.NDArray[np.bool_], shape: Shape
) -> npt.NDArray[np.float32]:
    """Crops (N, rows, columns, 2) of one image centred on joints (N, 3), mirrored where asked (N,)."""
    flat_mm, first, width, height, intrinsics = image
    out = np.empty((len(joints_m), shape[0], shape[1], 2), np.float32)
    fx, fy, cx, cy = intrinsics
    for k in range(len(joints_m)):
        x, y, z = joints_m[k]
        centre = (cx + fx * x / z, cy - fy * y / z, z)
        sample_crop(flat_mm, first, width, height, centre, (fx, fy), mirror[k], shape, out[k])
    return out
