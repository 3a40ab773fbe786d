"""Connected surfaces of a decimated depth grid."""

from __future__ import annotations

from dataclasses import dataclass

import numba as nb
import numpy as np
import numpy.typing as npt


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
