"""Metric crops of the operator: depth averaged in cells of a fixed size in metres, whatever camera and distance.

The same functions serve training and run time. Images are canonical (see ``teleop.body.features``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.features import FAR_MM

EMPTY: Final = 1.5
"""What a cell without a pixel reads, in the crop's units of depth."""


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


WHOLE: Final = CropShape(112, 96, 0.0225, 0.5, -2.0, 1.0)
"""The operator: 2.52 m high, 2.16 m wide."""
LOCAL: Final = CropShape(32, 32, 0.0125, 0.25, -1.5, 1.5)
"""Round one joint: 0.4 m wide."""


@nb.njit(cache=True, nogil=True)
def body_centre(flat_mm: npt.NDArray[np.int16], first: int, width: int, height: int) -> tuple[float, float, float]:
    """Median column, row and depth in m of the body pixels of the image that begins at ``first``."""
    columns, rows = np.zeros(width, np.int64), np.zeros(height, np.int64)
    depths = np.zeros(FAR_MM // 8 + 1, np.int64)
    for r in range(height):
        for c in range(width):
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


@nb.njit(cache=True, nogil=True)
def crop_cells(
    flat_mm: npt.NDArray[np.int16],
    first: int,
    width: int,
    height: int,
    column: float,
    row: float,
    depth_m: float,
    focal_x_px: float,
    focal_y_px: float,
    mirror: bool,
    rows: int,
    columns: int,
    cell_m: float,
    unit_m: float,
    near: float,
    far: float,
) -> npt.NDArray[np.float32]:
    """A crop (rows, columns, 2): mean depth of each cell relative to ``depth_m``, and the share of the cell covered.

    The crop is centred on (column, row) of the image that begins at ``first``; mirror turns it about that column.
    """
    total = np.zeros((rows, columns), np.float32)
    count = np.zeros((rows, columns), np.float32)
    per_x, per_y = focal_x_px * cell_m / depth_m, focal_y_px * cell_m / depth_m
    r0, r1 = max(0, int(np.floor(row - 0.5 * rows * per_y))), min(height, int(row + 0.5 * rows * per_y) + 2)
    c0, c1 = max(0, int(np.floor(column - 0.5 * columns * per_x))), min(width, int(column + 0.5 * columns * per_x) + 2)
    cell = np.empty(max(c1 - c0, 0), np.int64)
    for c in range(c0, c1):
        across = (c - column) / per_x
        cell[c - c0] = int(np.floor((-across if mirror else across) + 0.5 * columns))
    for r in range(r0, r1):
        y = int(np.floor((r - row) / per_y + 0.5 * rows))
        if y < 0 or y >= rows:
            continue
        for c in range(c0, c1):
            z = flat_mm[first + r * width + c]
            x = cell[c - c0]
            if z < FAR_MM and 0 <= x < columns:
                total[y, x] += z
                count[y, x] += 1
    out = np.empty((rows, columns, 2), np.float32)
    whole = per_x * per_y
    for y in range(rows):
        for x in range(columns):
            n = count[y, x]
            out[y, x, 0] = min(max((total[y, x] / n * 1e-3 - depth_m) / unit_m, near), far) if n > 0 else EMPTY
            out[y, x, 1] = min(n / whole, 1.0)
    return out
