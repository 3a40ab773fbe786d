"""The floor plane: RANSAC on the level cells of a decimated cloud, checked against the last frame first."""

from __future__ import annotations

from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.config.body import FloorConfig
from teleop.skeleton import FloorPlane

MIN_EXTENT_M: Final = 0.7
"""A floor is seen over at least this much in x or z; the top of a shoe or a shoulder is smaller."""
NOISE_M: Final = 0.0056
"""A Kinect's noise at 2 m."""
LOW_M: Final = -0.05
"""A floor is lower than this, in camera axes."""
F32 = npt.NDArray[np.float32]
Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]


@nb.njit(cache=True, nogil=True)
def count_plane(points_m: F32, level: Bools, normal: Floats, height_m: float, inlier_m: float) -> tuple[int, int]:
    """Level points on the plane and points of any kind clearly below it. The band grows with z^2 as the sensor's noise
    does."""
    on = below = 0
    for i in range(len(points_m)):
        z = points_m[i, 2]
        band = inlier_m * max(1.0, z * z * 0.25)
        h = normal[0] * points_m[i, 0] + normal[1] * points_m[i, 1] + normal[2] * z + height_m
        if h < -2.0 * band:
            below += 1
        elif h < band and level[i]:
            on += 1
    return on, below


@nb.njit(cache=True, nogil=True)
def search_plane(
    points_m: F32,
    level: Bools,
    picks: npt.NDArray[np.int64],
    min_cosine: float,
    min_height_m: float,
    max_height_m: float,
    inlier_m: float,
) -> tuple[Floats, float, int]:
    """Best plane through three of the points: normal (3,), sensor height, score (points on it minus points below)."""
    best = np.zeros(3)
    best_height = 0.0
    best_score = 0
    for trial in range(len(picks)):
        a = points_m[picks[trial, 0]].astype(np.float64)
        b = points_m[picks[trial, 1]].astype(np.float64) - a
        c = points_m[picks[trial, 2]].astype(np.float64) - a
        n = np.array([b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]])
        length = np.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
        if length < 1e-3:
            continue
        n = n / length if n[1] > 0 else -n / length
        height = -(n[0] * a[0] + n[1] * a[1] + n[2] * a[2])
        if n[1] < min_cosine or height < min_height_m or height > max_height_m:
            continue
        on, below = count_plane(points_m, level, n, height, inlier_m)
        score = on - 2 * below
        if score > best_score:
            best, best_height, best_score = n, height, score
    return best, best_height, best_score


def find_floor(points_m: F32, level: Bools, previous: FloorPlane | None, config: FloorConfig) -> FloorPlane | None:
    """Floor plane of a cloud (N, 3) in camera axes, or None where no floor is to be seen. level: (N,) which points may
    lie on it, see teleop.body.grid.cloud.

    A previous plane that still fits is refined instead of searched anew. Deterministic: the trials are drawn from a
    fixed seed. Fischler and Bolles 1981.
    """
    below_sensor = points_m[:, 1] < LOW_M
    low, low_level = points_m[below_sensor], level[below_sensor]
    flat = low[low_level]
    if len(flat) < config.min_inliers:
        return None
    if previous is not None:
        on, below = count_plane(low, low_level, previous.normal, previous.camera_height_m, config.inlier_m)
        if on >= config.min_inliers and below <= 0.25 * on:
            fresh = _refine(flat, previous.normal, previous.camera_height_m, config)
            return previous if fresh is None else _blend(previous, fresh, config.smoothing)
    picks = np.random.default_rng(20110620).integers(0, len(flat), (config.trials, 3))
    normal, height, score = search_plane(
        low,
        low_level,
        np.flatnonzero(low_level)[picks],
        float(np.cos(np.radians(config.max_tilt_deg))),
        config.min_height_m,
        config.max_height_m,
        config.inlier_m,
    )
    return None if score < config.min_inliers else _refine(flat, normal, height, config)


@nb.njit(cache=True, nogil=True)
def fit_plane(
    points_m: F32, normal: Floats, height_m: float, inlier_m: float
) -> tuple[Floats, float, int, float, float]:
    """Weighted least squares through the points near a plane, their number, their larger extent in x or z, and the
    standard error of the plane's pitch [rad].

    A point weighs 1 / noise^2, noise growing with z^2.
    """
    total, count = 0.0, 0
    centre, low, high = np.zeros(3), np.full(3, np.inf), np.full(3, -np.inf)
    square = np.zeros((3, 3))
    p = np.zeros(3)
    for i in range(len(points_m)):
        z = points_m[i, 2]
        noise = max(1.0, z * z * 0.25)
        h = normal[0] * points_m[i, 0] + normal[1] * points_m[i, 1] + normal[2] * z + height_m
        if abs(h) >= inlier_m * noise:
            continue
        count += 1
        w = 1.0 / (noise * noise)
        total += w
        for a in range(3):
            # about a point of the plane before, so that squares stay small
            p[a] = points_m[i, a] + normal[a] * height_m
            low[a], high[a] = min(low[a], p[a]), max(high[a], p[a])
            centre[a] += w * p[a]
        for a in range(3):
            for b in range(a + 1):
                square[a, b] += w * p[a] * p[b]
    if count < 3:
        return normal, height_m, count, 0.0, np.inf
    centre /= total
    for a in range(3):
        for b in range(a + 1):
            square[a, b] = square[b, a] = square[a, b] / total - centre[a] * centre[b]
    new = np.ascontiguousarray(np.linalg.eigh(square)[1][:, 0])
    if new[1] < 0:
        new = -new
    at = centre - normal * height_m
    new_height = -(new[0] * at[0] + new[1] * at[1] + new[2] * at[2])
    pitch_rad = NOISE_M / np.sqrt(max(total * square[2, 2], 1e-12))
    return new, new_height, count, max(high[0] - low[0], high[2] - low[2]), pitch_rad


def _refine(points_m: F32, normal: Floats, height_m: float, config: FloorConfig) -> FloorPlane | None:
    """Plane through the inliers, or None where they are too few, too small a patch, or a strip too thin to tell how it
    is tilted.

    Fitted again with a narrower band: shoes and the feet of things lie within the first one and tilt it.
    """
    pitch_rad = np.inf
    for share in (1.0, 0.8, 0.8):
        normal, height_m, count, extent_m, pitch_rad = fit_plane(points_m, normal, height_m, share * config.inlier_m)
        if count < 0.5 * config.min_inliers or extent_m < MIN_EXTENT_M:
            return None
    sure = pitch_rad <= np.radians(config.max_error_deg) and normal[1] >= np.cos(np.radians(config.max_tilt_deg))
    return FloorPlane(normal, height_m) if sure else None


def _blend(old: FloorPlane, new: FloorPlane, weight: float) -> FloorPlane:
    normal = (1 - weight) * old.normal + weight * new.normal
    height = (1 - weight) * old.camera_height_m + weight * new.camera_height_m
    return FloorPlane(normal / np.linalg.norm(normal), height)
