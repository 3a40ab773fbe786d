"""The decimated depth image that segmentation works on, and what stands on the floor in it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.frames import DepthFrame, Intrinsics
from teleop.skeleton import FloorPlane

LEVEL_ROWS: Final = 2
"""A cell's slope is seen over so many rows: fewer drown in noise, more reach over the floor's edge."""
F32 = npt.NDArray[np.float32]
Window = tuple[int, int, int, int]
"""First row and column of a part of the grid, and the ends of both, excluded."""


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """Every step-th pixel of a frame.

    depth_mm: (h, w) uint16. across: (w,) and up: (h,) float32, x / z and y / z of a column and a row, camera axes.
    """

    step: int
    depth_mm: npt.NDArray[np.uint16]
    across: F32
    up: F32


def decimate(frame: DepthFrame, columns: int) -> Grid:
    """A grid of about ``columns`` columns."""
    step = max(1, round(frame.camera.depth.width / columns))
    depth_mm = np.ascontiguousarray(frame.depth_mm[::step, ::step])
    across, up = _rays(frame.camera.depth, frame.camera.x_sign, step, depth_mm.shape[1], depth_mm.shape[0])
    return Grid(step, depth_mm, across, up)


@lru_cache(maxsize=8)
def _rays(k: Intrinsics, x_sign: float, step: int, columns: int, rows: int) -> tuple[F32, F32]:
    u, v = np.arange(columns, dtype=np.float64) * step, np.arange(rows, dtype=np.float64) * step
    return (
        (x_sign / k.fx * (u - k.cx)).astype(np.float32),
        (-1.0 / k.fy * (v - k.cy)).astype(np.float32),
    )


@nb.njit(cache=True, nogil=True)
def _is_steep(
    one_mm: np.int64, other_mm: np.int64, across: np.float32, one_up: np.float32, other_up: np.float32
) -> bool:
    """Whether the surface between two cells of a column is steeper than 45 degrees."""
    dz = np.float32(other_mm - one_mm)
    dx, dy = across * dz, other_up * np.float32(other_mm) - one_up * np.float32(one_mm)
    return bool(dy * dy >= dx * dx + dz * dz)


@nb.njit(cache=True, nogil=True)
def _cloud(
    depth_mm: npt.NDArray[np.uint16], across: F32, up: F32, near_mm: int, far_mm: int
) -> tuple[F32, npt.NDArray[np.bool_]]:
    h, w = depth_mm.shape
    points, level = np.empty((h * w, 3), np.float32), np.empty(h * w, np.bool_)
    n = 0
    for r in range(h):
        for c in range(w):
            d = np.int64(depth_mm[r, c])
            if not near_mm < d < far_mm:
                continue
            seen, steep = False, False
            for other in (r - LEVEL_ROWS, r + LEVEL_ROWS):
                if 0 <= other < h:
                    e = np.int64(depth_mm[other, c])
                    if near_mm < e < far_mm:
                        seen = True
                        steep |= _is_steep(d, e, across[c], up[r], up[other])
            z = np.float32(d) * np.float32(1e-3)
            points[n, 0], points[n, 1], points[n, 2] = across[c] * z, up[r] * z, z
            level[n] = seen and not steep
            n += 1
    return points[:n], level[:n]


def cloud(grid: Grid, near_m: float, far_m: float) -> tuple[F32, npt.NDArray[np.bool_]]:
    """Points (N, 3) in camera axes of the cells between two depths, and which of them (N,) may lie on a floor: the
    surface rises by less than 45 degrees, in camera axes, from them to the cells LEVEL_ROWS above and below.

    The foot of a wall lies within a floor's noise; with it the plane tilts by degrees.
    """
    points, level = _cloud(grid.depth_mm, grid.across, grid.up, round(near_m * 1000), round(far_m * 1000))
    return points, level


@nb.njit(cache=True, nogil=True)
def _standing(
    depth_mm: npt.NDArray[np.uint16],
    across: F32,
    up: F32,
    near_mm: int,
    far_mm: int,
    R: F32,
    height_m: float,
    clearance_m: float,
    points: F32,
) -> npt.NDArray[np.bool_]:
    h, w = depth_mm.shape
    usable = np.zeros((h, w), np.bool_)
    for r in range(h):
        for c in range(w):
            d = np.int64(depth_mm[r, c])
            if not near_mm < d < far_mm:
                continue
            z = np.float32(d) * np.float32(1e-3)
            x, y = across[c] * z, up[r] * z
            for a in range(3):
                points[r, c, a] = R[a, 0] * x + R[a, 1] * y + R[a, 2] * z
            points[r, c, 1] += np.float32(height_m)
            # the band of the floor grows with z^2 as the sensor's noise does
            usable[r, c] = points[r, c, 1] > np.float32(clearance_m) * max(np.float32(1.0), np.float32(0.25) * z * z)
    return usable


def standing(
    grid: Grid, near_m: float, far_m: float, floor: FloorPlane | None, clearance_m: float
) -> tuple[npt.NDArray[np.bool_], F32]:
    """Cells (h, w) above the floor, and the levelled points (h, w, 3) of all cells, y the height above the floor;
    camera axes without a floor."""
    points = np.zeros((*grid.depth_mm.shape, 3), np.float32)
    R, height_m, clear_m = np.eye(3, dtype=np.float32), 0.0, -np.inf
    if floor is not None:
        R, height_m, clear_m = floor.R_level_camera().astype(np.float32), floor.camera_height_m, clearance_m
    near_mm, far_mm = round(near_m * 1000), round(far_m * 1000)
    usable = _standing(grid.depth_mm, grid.across, grid.up, near_mm, far_mm, R, height_m, clear_m, points)
    return usable, points
