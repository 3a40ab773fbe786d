"""Gaussian mean shift over weighted points (source eq. (3); Comaniciu and Meer 2002)."""

from __future__ import annotations

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.exponent import exp_in_place

F32 = npt.NDArray[np.float32]


@nb.njit(cache=True, nogil=True, fastmath={"reassoc", "nsz", "contract"})
def _pull(
    points_m: F32, kernel: F32, x: np.float32, y: np.float32, z: np.float32
) -> tuple[np.float32, np.float32, np.float32, np.float32]:
    """The kernel's sum, and the sums of the ways from (x, y, z) to the points, by it."""
    px, py, pz = points_m[0], points_m[1], points_m[2]
    total = sx = sy = sz = np.float32(0)
    for i in range(np.uint64(len(kernel))):
        w = kernel[i]
        total += w
        sx += w * (px[i] - x)
        sy += w * (py[i] - y)
        sz += w * (pz[i] - z)
    return total, sx, sy, sz


@nb.njit(cache=True, nogil=True)
def _exponents(points_m: F32, x: np.float32, y: np.float32, z: np.float32, inverse: np.float32, out: F32) -> None:
    px, py, pz = points_m[0], points_m[1], points_m[2]
    for i in range(np.uint64(len(out))):
        dx, dy, dz = px[i] - x, py[i] - y, pz[i] - z
        out[i] = -(dx * dx + dy * dy + dz * dz) * inverse


@nb.njit(cache=True, nogil=True)
def _weigh(kernel: F32, weights: F32, scale: np.float32) -> None:
    for i in range(np.uint64(len(kernel))):
        kernel[i] *= weights[i] * scale


@nb.njit(cache=True, nogil=True)
def shift_to_mode(
    points_m: F32,
    weights: F32,
    start_m: npt.NDArray[np.float64],
    bandwidth_m: float,
    iterations: int,
    tolerance_m: float,
) -> npt.NDArray[np.float64]:
    """Mode (3,) reached from a start. points_m: (3, N). Kernel exp(-|(p - p_i) / b|^2)."""
    x, y, z = start_m[0], start_m[1], start_m[2]
    inverse = np.float32(1.0 / (bandwidth_m * bandwidth_m))
    heaviest = weights.max()
    if not heaviest > 0:
        return start_m
    # relative to the heaviest: squares of small weights would leave float32's range
    scale = np.float32(1) / heaviest
    kernel, powers = np.empty(len(weights), np.float32), np.empty(len(weights), np.int32)
    for _ in range(iterations):
        fx, fy, fz = np.float32(x), np.float32(y), np.float32(z)
        _exponents(points_m, fx, fy, fz, inverse, kernel)
        exp_in_place(kernel, powers)
        _weigh(kernel, weights, scale)
        total, sx, sy, sz = _pull(points_m, kernel, fx, fy, fz)
        if total < 1e-30:
            break
        sx, sy, sz = sx / total, sy / total, sz / total
        x, y, z = fx + sx, fy + sy, fz + sz
        if sx * sx + sy * sy + sz * sz < tolerance_m * tolerance_m:
            break
    return np.array([x, y, z])


@nb.njit(cache=True, nogil=True)
def find_modes(
    points_m: F32,
    weights: F32,
    bandwidth_m: float,
    starts: int,
    iterations: int,
    tolerance_m: float,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Distinct modes of a density, best first.

    points_m: (3, N), or more that do not count. weights: (N,). starts: greedy starts, each the heaviest point farther
    than two bandwidths from every mode found so far. Returns modes (S, 3), rows NaN where there are fewer, and scores
    (S,): the summed weight of the points within two bandwidths, a better confidence than the density (Shotton 2011).
    """
    n = len(weights)
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
        start = points_m[:, best].astype(np.float64)
        mode = shift_to_mode(points_m, weights, start, bandwidth_m, iterations, tolerance_m)
        free[best] = False
        score = 0.0
        for i in range(n):
            dx, dy, dz = points_m[0, i] - mode[0], points_m[1, i] - mode[1], points_m[2, i] - mode[2]
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
