"""Connected surfaces of a decimated depth grid."""

from __future__ import annotations

from dataclasses import dataclass

import numba as nb
import numpy as np
import numpy.typing as npt


@nb.njit(cache=True, nogil=True)
def label_surfaces(
    depth_m: npt.NDArray[np.float32], usable: npt.NDArray[np.bool_], jump_m: float
) -> tuple[npt.NDArray[np.int32], int]:
    """Label (h, w) of each usable cell, -1 elsewhere, and the number of labels.

    Neighbours belong together when their depths differ by less than ``jump_m`` at 2 m, growing with z^2 as
    quantisation does. One unusable cell between two is bridged: dropouts would cut thin arms.
    """
    height, width = depth_m.shape
    labels = np.full((height, width), -1, np.int32)
    stack = np.empty((height * width, 2), np.int32)
    count = 0
    for r0 in range(height):
        for c0 in range(width):
            if not usable[r0, c0] or labels[r0, c0] >= 0:
                continue
            labels[r0, c0] = count
            stack[0, 0], stack[0, 1] = r0, c0
            top = 1
            while top > 0:
                top -= 1
                r, c = stack[top, 0], stack[top, 1]
                z = depth_m[r, c]
                limit = jump_m * max(1.0, z * z * 0.25)
                for direction in range(4):
                    dr = (direction == 0) - (direction == 1)
                    dc = (direction == 2) - (direction == 3)
                    for reach in range(1, 3):
                        rr, cc = r + dr * reach, c + dc * reach
                        if rr < 0 or cc < 0 or rr >= height or cc >= width:
                            break
                        if usable[rr, cc]:
                            if labels[rr, cc] < 0 and abs(depth_m[rr, cc] - z) < limit:
                                labels[rr, cc] = count
                                stack[top, 0], stack[top, 1] = rr, cc
                                top += 1
                            break
            count += 1
    return labels, count


@dataclass(frozen=True, slots=True, eq=False)
class Surfaces:
    """Figures of all labels, arrays over the labels.

    area_m2: (C,) visible surface facing the sensor. low_m, high_m: (C, 3) levelled extents; y is height (above the
    floor where it is known, else above the sensor). centre_m: (C, 3) mean, same axes. cells: (C,).
    """

    area_m2: npt.NDArray[np.float64]
    low_m: npt.NDArray[np.float64]
    high_m: npt.NDArray[np.float64]
    centre_m: npt.NDArray[np.float64]
    cells: npt.NDArray[np.int64]


@nb.njit(cache=True, nogil=True)
def _measure(
    labels: npt.NDArray[np.int32], points_m: npt.NDArray[np.float32], depth_m: npt.NDArray[np.float32], count: int
) -> tuple[
    npt.NDArray[np.float64],
    npt.NDArray[np.float64],
    npt.NDArray[np.float64],
    npt.NDArray[np.float64],
    npt.NDArray[np.int64],
]:
    low = np.full((count, 3), np.inf)
    high = np.full((count, 3), -np.inf)
    centre = np.zeros((count, 3))
    square = np.zeros(count)
    cells = np.zeros(count, np.int64)
    for r in range(labels.shape[0]):
        for c in range(labels.shape[1]):
            k = labels[r, c]
            if k >= 0:
                cells[k] += 1
                square[k] += depth_m[r, c] * depth_m[r, c]
                for a in range(3):
                    p = points_m[r, c, a]
                    low[k, a] = min(low[k, a], p)
                    high[k, a] = max(high[k, a], p)
                    centre[k, a] += p
    for k in range(count):
        centre[k] /= cells[k]
    return square, low, high, centre, cells


def measure_surfaces(
    labels: npt.NDArray[np.int32],
    points_m: npt.NDArray[np.float32],
    depth_m: npt.NDArray[np.float32],
    count: int,
    cell_per_focal: float,
) -> Surfaces:
    """Figures of each label. points_m: (h, w, 3) levelled. cell_per_focal: width of a cell at 1 m [m]."""
    square, low, high, centre, cells = _measure(labels, points_m, depth_m, count)
    return Surfaces(square * cell_per_focal**2, low, high, centre, cells)


@nb.njit(cache=True, nogil=True)
def adjacency(labels: npt.NDArray[np.int32], main: int, count: int, reach: int) -> npt.NDArray[np.int32]:
    """Number of cells (C,) of each label that lie within ``reach`` cells of label ``main`` along a row or column."""
    height, width = labels.shape
    out = np.zeros(count, np.int32)
    for r in range(height):
        for c in range(width):
            k = labels[r, c]
            if k < 0 or k == main:
                continue
            near = False
            for direction in range(4):
                dr = (direction == 0) - (direction == 1)
                dc = (direction == 2) - (direction == 3)
                for step in range(1, reach + 1):
                    rr, cc = r + dr * step, c + dc * step
                    if 0 <= rr < height and 0 <= cc < width and labels[rr, cc] == main:
                        near = True
            if near:
                out[k] += 1
    return out


@nb.njit(cache=True, nogil=True)
def grow_mask(
    depth_mm: npt.NDArray[np.uint16],
    chosen: npt.NDArray[np.bool_],
    grid_mm: npt.NDArray[np.uint16],
    step: int,
    jump_m: float,
    floor_row: npt.NDArray[np.float64],
) -> npt.NDArray[np.bool_]:
    """Full-resolution mask (H, W): pixels whose depth agrees with a chosen cell round them.

    floor_row: (4,) a, b, c, e with height above the cut ``z (a u + b v + c) + e``; (0, 0, 0, 1) cuts nothing.
    """
    height, width = depth_mm.shape
    rows, columns = chosen.shape
    mask = np.zeros((height, width), np.bool_)
    limit = np.empty((rows, columns), np.float32)
    for r in range(rows):
        for c in range(columns):
            z = grid_mm[r, c] * np.float32(1e-3)
            limit[r, c] = jump_m * 1000.0 * max(np.float32(1.0), z * z * np.float32(0.25))
    for r in range(rows):
        for c in range(columns):
            near = False
            for rr in range(max(r - 1, 0), min(r + 2, rows)):
                for cc in range(max(c - 1, 0), min(c + 2, columns)):
                    near |= chosen[rr, cc]
            if not near:
                continue
            for v in range(r * step, min(r * step + step, height)):
                for u in range(c * step, min(c * step + step, width)):
                    d = np.int32(depth_mm[v, u])
                    if d == 0 or d * 1e-3 * (floor_row[0] * u + floor_row[1] * v + floor_row[2]) + floor_row[3] <= 0:
                        continue
                    # nearly always its own cell agrees
                    inside = chosen[r, c] and abs(d - np.int32(grid_mm[r, c])) < limit[r, c]
                    if not inside:
                        for rr in range(max(r - 1, 0), min(r + 2, rows)):
                            for cc in range(max(c - 1, 0), min(c + 2, columns)):
                                inside |= chosen[rr, cc] and abs(d - np.int32(grid_mm[rr, cc])) < limit[rr, cc]
                    mask[v, u] = inside
    return mask
