"""The operator's mask at full resolution, grown from the cells of the decimated grid that are theirs."""

from __future__ import annotations

from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

I32 = npt.NDArray[np.int32]
_NONE: Final = 1 << 30
"""Larger than any depth [mm]."""


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
def _per_pixel(
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
def _is_above(d: np.int32, slope: np.float32, e: np.float32) -> bool:
    """Whether a depth [mm] lies above the cut, see grow_mask."""
    return bool(np.float32(d) * np.float32(1e-3) * slope + e > np.float32(0))


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
        inside[u] = (d > over[u]) & (d < under[u]) & _is_above(d, across[u] + row, e)


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
        some_parted = _per_pixel(c0, c1, least, most, parted, step, over, under)
        for v in range(r * step, min(r * step + step, height)):
            line, inside, row = depth_mm[v], mask[v], b * np.float32(v)
            _test_row(line, begin, end, over, under, across, row, e, inside)
            for c in range(c0, c1 if some_parted else c0):
                if parted[c]:
                    for u in range(c * step, min(c * step + step, width)):
                        d = np.int32(line[u])
                        inside[u] = _is_above(d, across[u] + row, e) and _agrees(d, low, high, r, c)
            count = _count_row(inside, begin, end, per_column)
            if count > 0:
                area, v0, v1 = area + count, min(v0, v), v + 1
    filled = np.flatnonzero(per_column)
    if area == 0:
        return mask, 0, (width, height, 0, 0)
    return mask, area, (int(filled[0]), v0, int(filled[-1]) + 1, v1)
