"""Gaussian mean shift over weighted points (source eq. (3); Comaniciu and Meer 2002)."""

from __future__ import annotations

import numba as nb
import numpy as np
import numpy.typing as npt


@nb.njit(cache=True, nogil=True)
def shift_to_mode(
    points_m: npt.NDArray[np.float32],
    weights: npt.NDArray[np.float32],
    start_m: npt.NDArray[np.float64],
    bandwidth_m: float,
    iterations: int,
    tolerance_m: float,
) -> npt.NDArray[np.float64]:
    """Mode (3,) reached from a start. Kernel exp(-|(p - p_i) / b|^2), cut at 3 b where it is 1e-4."""
    x, y, z = start_m[0], start_m[1], start_m[2]
    inverse = 1.0 / (bandwidth_m * bandwidth_m)
    for _ in range(iterations):
        sx = sy = sz = total = 0.0
        for i in range(len(points_m)):
            dx = points_m[i, 0] - x
            dy = points_m[i, 1] - y
            dz = points_m[i, 2] - z
            q = (dx * dx + dy * dy + dz * dz) * inverse
            if q < 9.0:
                w = weights[i] * np.exp(-q)
                total += w
                sx += w * dx
                sy += w * dy
                sz += w * dz
        if total <= 0.0:
            break
        sx, sy, sz = sx / total, sy / total, sz / total
        x, y, z = x + sx, y + sy, z + sz
        if sx * sx + sy * sy + sz * sz < tolerance_m * tolerance_m:
            break
    return np.array([x, y, z])


@nb.njit(cache=True, nogil=True)
def find_modes(
    points_m: npt.NDArray[np.float32],
    weights: npt.NDArray[np.float32],
    bandwidth_m: float,
    starts: int,
    iterations: int,
    tolerance_m: float,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Distinct modes of a density, best first.

    points_m: (N, 3). weights: (N,). starts: greedy starts, each the heaviest point farther than two bandwidths from
    every mode found so far. Returns modes (S, 3), rows NaN where there are fewer, and scores (S,): the summed weight
    of the points within two bandwidths, a better confidence than the density (Shotton 2011).
    """
    n = len(points_m)
    modes = np.full((starts, 3), np.nan)
    scores = np.zeros(starts)
    free = np.ones(n, np.bool_)
    radius2 = 4.0 * bandwidth_m * bandwidth_m
    found = 0
    for _ in range(starts):
        best = -1
        for i in range(n):
            if free[i] and (best < 0 or weights[i] > weights[best]):
                best = i
        if best < 0 or weights[best] <= 0:
            break
        start = points_m[best].astype(np.float64)
        mode = shift_to_mode(points_m, weights, start, bandwidth_m, iterations, tolerance_m)
        free[best] = False
        score = 0.0
        for i in range(n):
            dx, dy, dz = points_m[i, 0] - mode[0], points_m[i, 1] - mode[1], points_m[i, 2] - mode[2]
            if (free[i] or i == best) and dx * dx + dy * dy + dz * dz < radius2:
                score += weights[i]
                free[i] = False
        same = False
        for k in range(found):
            d = modes[k] - mode
            if d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < 0.25 * radius2:
                scores[k] += score
                same = True
                break
        if not same:
            modes[found] = mode
            scores[found] = score
            found += 1
    order = np.argsort(-scores)
    return modes[order], scores[order]
