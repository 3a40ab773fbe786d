"""Connected surfaces of a decimated depth grid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

I32 = npt.NDArray[np.int32]
_NONE: Final = 1 << 30
"""Larger than any depth [mm]."""


@nb.njit(cache=True, nogil=True)
def label_surfaces(
    depth_mm: npt.NDArray[np.uint16], usable: npt.NDArray[np.bool_], jump_m: float
) -> tuple[npt.NDArray[np.int32], int]:
    """Label (h, w) of each usable cell, -1 elsewhere, and the number of labels.

    Neighbours belong together when their depths differ by less than ``jump_m`` at 2 m, growing with z^2 as
    quantisation does. One unusable cell between two is bridged: dropouts would cut thin arms.
    """
    height, width = depth_mm.shape
    limits = np.float32(1000.0 * jump_m)
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
                z = np.int32(depth_mm[r, c])
                metres = np.float32(z) * np.float32(1e-3)
                limit = limits * max(np.float32(1.0), metres * metres * np.float32(0.25))
                for direction in range(4):
                    dr = (direction == 0) - (direction == 1)
                    dc = (direction == 2) - (direction == 3)
                    for reach in range(1, 3):
                        rr, cc = r + dr * reach, c + dc * reach
                        if rr < 0 or cc < 0 or rr >= height or cc >= width:
                            break
                        if usable[rr, cc]:
                            if labels[rr, cc] < 0 and abs(np.int32(depth_mm[rr, cc]) - z) < limit:
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
    floor where it is known, else above the sensor). centre_m: (C, 3) mean, same axes. cells: (C,). person: (C,) mean
    probability that a cell shows a person, 1 where nobody asked.
    """

    area_m2: npt.NDArray[np.float64]
    low_m: npt.NDArray[np.float64]
    high_m: npt.NDArray[np.float64]
    centre_m: npt.NDArray[np.float64]
    cells: npt.NDArray[np.int64]
    person: npt.NDArray[np.float64]


@nb.njit(cache=True, nogil=True)
def _measure(
    labels: npt.NDArray[np.int32],
    points_m: npt.NDArray[np.float32],
    depth_mm: npt.NDArray[np.uint16],
    person: npt.NDArray[np.float32],
    count: int,
) -> npt.NDArray[np.float64]:
    """Rows (C, 12): cells, sum of squared depths, of probabilities, low, high and summed points."""
    out = np.zeros((count, 12))
    out[:, 3:6], out[:, 6:9] = np.inf, -np.inf
    for r in range(labels.shape[0]):
        for c in range(labels.shape[1]):
            k = labels[r, c]
            if k >= 0:
                z = np.float64(depth_mm[r, c]) * 1e-3
                out[k, 0] += 1.0
                out[k, 1] += z * z
                out[k, 2] += person[r, c] if person.size else 1.0
                for a in range(3):
                    p = points_m[r, c, a]
                    out[k, 3 + a] = min(out[k, 3 + a], p)
                    out[k, 6 + a] = max(out[k, 6 + a], p)
                    out[k, 9 + a] += p
    return out


def measure_surfaces(
    labels: npt.NDArray[np.int32],
    points_m: npt.NDArray[np.float32],
    depth_mm: npt.NDArray[np.uint16],
    person: npt.NDArray[np.float32] | None,
    count: int,
    cell_per_focal: float,
) -> Surfaces:
    """Figures of each label. points_m: (h, w, 3) levelled. person: (h, w) or None. cell_per_focal: width of a cell at
    1 m [m]."""
    cells = np.zeros((0, 0), np.float32) if person is None else person
    m = _measure(labels, points_m, depth_mm, cells, count)
    n = m[:, :1]
    # copies: kernels are compiled for each layout in memory they meet
    low_m, high_m = m[:, 3:6].copy(), m[:, 6:9].copy()
    return Surfaces(
        m[:, 1] * cell_per_focal**2, low_m, high_m, m[:, 9:] / n, m[:, 0].astype(np.int64), m[:, 2] / m[:, 0]
    )


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
def _agreeing(
    labels: npt.NDArray[np.int32], members: npt.NDArray[np.bool_], grid_mm: npt.NDArray[np.uint16], jump_m: float
) -> tuple[I32, I32, tuple[int, int, int, int]]:
    """Depths (rows + 2, columns + 2) that agree with each chosen cell lie between these two, _NONE and 0 where nothing
    does; the box (c0, r0, c1, r1) round all chosen cells and one more. The grid has a frame of one cell here."""
    rows, columns = labels.shape
    low, high = np.full((rows + 2, columns + 2), _NONE, np.int32), np.zeros((rows + 2, columns + 2), np.int32)
    c0, r0, c1, r1 = columns, rows, 0, 0
    for r in range(rows):
        for c in range(columns):
            if labels[r, c] >= 0 and members[labels[r, c]]:
                c0, r0, c1, r1 = min(c0, c), min(r0, r), max(c1, c + 1), max(r1, r + 1)
                z, d = grid_mm[r, c] * np.float32(1e-3), np.int32(grid_mm[r, c])
                limit = np.int32(jump_m * 1000.0 * max(np.float32(1.0), z * z * np.float32(0.25)))
                low[r + 1, c + 1], high[r + 1, c + 1] = max(0, d - limit), d + limit
    return low, high, (max(0, c0 - 1), max(0, r0 - 1), min(columns, c1 + 1), min(rows, r1 + 1))


@nb.njit(cache=True, nogil=True)
def _around(low: I32, high: I32, r: int, down: I32, least: I32, most: I32, parted: npt.NDArray[np.bool_]) -> None:
    """The least and the most (columns,) that agrees with a cell of row r or one round it, and whether some depth
    between them may not. down: (4, columns + 2), to work in."""
    for c in range(np.uint64(down.shape[1])):
        a, b, d = low[r, c], low[r + 1, c], low[r + 2, c]
        e, f, g = high[r, c], high[r + 1, c], high[r + 2, c]
        down[0, c], down[1, c] = min(a, b, d), max(e, f, g)
        down[2, c] = max(a if a < _NONE else 0, b if b < _NONE else 0, d if d < _NONE else 0)
        down[3, c] = min(e if e > 0 else _NONE, f if f > 0 else _NONE, g if g > 0 else _NONE)
    for c in range(np.uint64(len(least))):
        left, right = c + np.uint64(1), c + np.uint64(2)
        least[c] = min(down[0, c], down[0, left], down[0, right])
        most[c] = max(down[1, c], down[1, left], down[1, right])
        nearest_end = min(down[3, c], down[3, left], down[3, right])
        parted[c] = max(down[2, c], down[2, left], down[2, right]) >= nearest_end


@nb.njit(cache=True, nogil=True)
def _agrees(d: np.int32, low: I32, high: I32, r: int, c: int) -> bool:
    """Whether a depth agrees with cell (r, c) or one round it."""
    for rr in range(r, r + 3):
        for cc in range(c, c + 3):
            if low[rr, cc] < d < high[rr, cc]:
                return True
    return False


@nb.njit(cache=True, nogil=True)
def _spread(
    c0: int, c1: int, least: I32, most: I32, parted: npt.NDArray[np.bool_], step: int, over: I32, under: I32
) -> bool:
    """What agrees with cells, for each pixel of a row of them; nothing with a parted one. Whether one is parted."""
    wide, some = np.uint64(step), False
    for c in range(np.uint64(c0), np.uint64(c1)):
        first, low, high = c * wide, _NONE if parted[c] else least[c], most[c]
        some |= parted[c]
        for k in range(wide):
            over[first + k], under[first + k] = low, high
    return some


@nb.njit(cache=True, nogil=True)
def _test_row(
    line: npt.NDArray[np.uint16],
    begin: int,
    end: int,
    over: I32,
    under: I32,
    across: npt.NDArray[np.float32],
    row: np.float32,
    e: np.float32,
    inside: npt.NDArray[np.bool_],
) -> None:
    """Whether the pixels of a row lie between two depths and above the cut, see grow_mask."""
    for u in range(np.uint64(begin), np.uint64(end)):
        d = np.int32(line[u])
        above = np.float32(d) * np.float32(1e-3) * (across[u] + row) + e > np.float32(0)
        inside[u] = (d > over[u]) & (d < under[u]) & above


@nb.njit(cache=True, nogil=True)
def _count_row(inside: npt.NDArray[np.bool_], begin: int, end: int, per_column: I32) -> int:
    count = np.int32(0)
    for u in range(np.uint64(begin), np.uint64(end)):
        per_column[u] += np.int32(inside[u])
        count += np.int32(inside[u])
    return int(count)


@nb.njit(cache=True, nogil=True)
def grow_mask(
    depth_mm: npt.NDArray[np.uint16],
    labels: npt.NDArray[np.int32],
    members: npt.NDArray[np.bool_],
    grid_mm: npt.NDArray[np.uint16],
    step: int,
    jump_m: float,
    floor_row: npt.NDArray[np.float32],
) -> tuple[npt.NDArray[np.bool_], int, tuple[int, int, int, int]]:
    """Full-resolution mask (H, W): pixels whose depth agrees with a cell of the member labels (C,) round them; their
    number, and the box (u0, v0, u1, v1) round them, ends excluded.

    floor_row: (4,) a, b, c, e with height above the cut ``z (a u + b v + c) + e``; (0, 0, 0, 1) cuts nothing.
    """
    height, width = depth_mm.shape
    columns = labels.shape[1]
    mask = np.zeros((height, width), np.bool_)
    low, high, (c0, r0, c1, r1) = _agreeing(labels, members, grid_mm, jump_m)
    begin, end = c0 * step, min(c1 * step, width)
    if begin >= end:
        return mask, 0, (width, height, 0, 0)
    a, b, top, e = floor_row
    across = a * np.arange(width).astype(np.float32) + top
    down = np.empty((4, columns + 2), np.int32)
    least, most, parted = np.empty(columns, np.int32), np.empty(columns, np.int32), np.empty(columns, np.bool_)
    # per pixel of a row, so that many pixels are tested at once
    over, under = np.empty(columns * step, np.int32), np.empty(columns * step, np.int32)
    per_column = np.zeros(width, np.int32)
    area, v0, v1 = 0, height, 0
    for r in range(r0, r1):
        _around(low, high, r, down, least, most, parted)
        some_parted = _spread(c0, c1, least, most, parted, step, over, under)
        for v in range(r * step, min(r * step + step, height)):
            line, inside, row = depth_mm[v], mask[v], b * np.float32(v)
            _test_row(line, begin, end, over, under, across, row, e, inside)
            for c in range(c0, c1 if some_parted else c0):
                if parted[c]:
                    for u in range(c * step, min(c * step + step, width)):
                        d = np.int32(line[u])
                        above = np.float32(d) * np.float32(1e-3) * (across[u] + row) + e > np.float32(0)
                        inside[u] = above and _agrees(d, low, high, r, c)
            count = _count_row(inside, begin, end, per_column)
            if count > 0:
                area, v0, v1 = area + count, min(v0, v), v + 1
    filled = np.flatnonzero(per_column)
    if area == 0:
        return mask, 0, (width, height, 0, 0)
    return mask, area, (int(filled[0]), v0, int(filled[-1]) + 1, v1)
