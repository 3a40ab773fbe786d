"""A dense path as few key points: shortcuts that stay clear, then points no further apart than a trajectory wants."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from robot_sim.errors import RobotError
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.planner.scene import Scene


def path_length(points_m: FloatArray) -> float:
    """Sum of the distances between successive points (M, 3) (the grape source's (11)), m."""
    return float(np.linalg.norm(np.diff(points_m, axis=0), axis=1).sum())


def thinned(points_m: FloatArray, tolerance_m: float) -> FloatArray:
    """Ramer, Douglas and Peucker's simplification: no point dropped lies further than the tolerance from the rest."""
    if tolerance_m <= 0 or len(points_m) < 3:
        return points_m
    keep = np.zeros(len(points_m), dtype=np.bool_)
    keep[[0, -1]] = True
    spans = [(0, len(points_m) - 1)]
    while spans:
        i, j = spans.pop()
        if j - i < 2:
            continue
        a, axis = points_m[i], points_m[j] - points_m[i]
        inner = points_m[i + 1 : j] - a
        size = float(axis @ axis)
        share = np.clip(inner @ axis / size, 0, 1) if size > 0 else np.zeros(len(inner))
        off = np.linalg.norm(inner - share[:, None] * axis, axis=1)
        k = int(np.argmax(off))
        if off[k] > tolerance_m:
            keep[i + 1 + k] = True
            spans += [(i, i + 1 + k), (i + 1 + k, j)]
    return np.asarray(points_m[keep])


def key_points(
    points_m: FloatArray,
    scene: Scene,
    offsets_m: FloatArray,
    radii_m: FloatArray,
    *,
    margin_m: float,
    spacing_m: float,
    tolerance_m: float = 0.003,
) -> FloatArray:
    """Key points (K, 3) of a dense path (M, 3): straight where the body keeps its margin, evenly spaced.

    A shortcut is taken only when the whole body keeps at least margin_m along it.
    """
    if spacing_m <= 0:
        raise RobotError(f"key points need a positive spacing, got {spacing_m} m")
    corners = [points_m[0]]
    i = 0
    dense = thinned(points_m, tolerance_m)
    while i < len(dense) - 1:
        j = len(dense) - 1
        while j > i + 1:
            length = float(np.linalg.norm(dense[j] - dense[i]))
            line = dense[i] + np.linspace(0, 1, max(2, int(length / 0.01) + 2))[:, None] * (dense[j] - dense[i])
            if scene.clearance(line, offsets_m, radii_m).min() >= margin_m:
                break
            j -= 1
        corners.append(dense[j])
        i = j
    out = [corners[0]]
    for a, b in pairwise(corners):
        count = max(1, int(np.ceil(np.linalg.norm(b - a) / spacing_m - 1e-9)))
        out += [a + s * (b - a) for s in np.linspace(0, 1, count + 1)[1:]]
    return np.array(out)
