"""What segmentation leaves on a cut-out person: bits of floor, furniture and wall, and bites out of the person."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from teleop.body.parts import NO_PART
from teleop.frames import Camera
from teleop.people.body import Bytes, Floats32
from teleop.people.rig import Floats

Window = tuple[slice, slice]


def _blob(
    u: float, v: float, ru: float, rv: float, shape: tuple[int, ...], rng: np.random.Generator
) -> tuple[Window, npt.NDArray[np.bool_]] | None:
    """A ragged ellipse: its window in the image and its pixels there."""
    v0, v1 = int(max(0, v - 1.4 * rv)), int(min(shape[0], v + 1.4 * rv + 1))
    u0, u1 = int(max(0, u - 1.4 * ru)), int(min(shape[1], u + 1.4 * ru + 1))
    if v1 - v0 < 2 or u1 - u0 < 2:
        return None
    y, x = np.ogrid[v0:v1, u0:u1]
    angle = np.arctan2(y - v, x - u)
    phase = rng.uniform(0, 2 * np.pi, 3)
    radius = 1.0 + 0.15 * sum(np.sin((k + 2) * angle + phase[k]) for k in range(3))
    return (slice(v0, v1), slice(u0, u1)), ((x - u) / ru) ** 2 + ((y - v) / rv) ** 2 < radius**2


def _cover(depth: Floats32, part: Bytes, window: Window, mask: npt.NDArray[np.bool_], z: npt.ArrayLike) -> None:
    nearer = mask & (np.asarray(z, np.float32) < depth[window])
    depth[window] = np.where(nearer, z, depth[window])
    part[window][nearer] = NO_PART


def add_floor(
    depth: Floats32, part: Bytes, feet_uv: Floats, camera: Camera, up: Floats, height_m: float, rng: np.random.Generator
) -> None:
    """A patch of floor round each foot (2, 2) pixels; up: (3,) the room's vertical in camera axes."""
    k = camera.depth
    for u, v in feet_uv:
        blob = _blob(u, v, rng.uniform(8, 60) * k.width / 640, rng.uniform(4, 25) * k.width / 640, depth.shape, rng)
        if blob is None:
            continue
        window, mask = blob
        y, x = np.ogrid[window]
        slope = up[0] * camera.x_sign * (x - k.cx) / k.fx - up[1] * (y - k.cy) / k.fy + up[2]
        z = np.where(slope < -0.02, height_m / np.maximum(-slope, 0.02), np.inf)
        _cover(depth, part, window, mask, z.astype(np.float32))


def add_fragment(depth: Floats32, part: Bytes, rng: np.random.Generator) -> None:
    """A piece of something flat beside, behind or before the person's outline."""
    rows, columns = np.nonzero(np.isfinite(depth))
    if not len(rows):
        return
    at = rng.integers(len(rows))
    u, v, z = float(columns[at]), float(rows[at]), float(depth[rows[at], columns[at]])
    side = rng.uniform(10, 70, 2) * 2.5 / z * depth.shape[1] / 640
    left, right = np.flatnonzero(np.isfinite(depth[int(v)]))[[0, -1]]
    u = float(rng.choice([left - 0.7 * side[0], right + 0.7 * side[0]]))
    blob = _blob(u, v, side[0], side[1], depth.shape, rng)
    if blob is None:
        return
    window, mask = blob
    y, x = np.ogrid[window]
    slope = rng.normal(0, 0.0012, 2)
    plane = z + rng.normal(0.2, 0.2) + slope[0] * (x - u) + slope[1] * (y - v)
    _cover(depth, part, window, mask, np.maximum(plane, 0.5).astype(np.float32))


def bite(depth: Floats32, part: Bytes, rng: np.random.Generator) -> None:
    """Take a piece out of the person: nothing is read there."""
    rows, columns = np.nonzero(np.isfinite(depth))
    if not len(rows):
        return
    at = rng.integers(len(rows))
    z = float(depth[rows[at], columns[at]])
    r = rng.uniform(3, 16, 2) * 2.5 / z * depth.shape[1] / 640
    blob = _blob(float(columns[at]), float(rows[at]), r[0], r[1], depth.shape, rng)
    if blob is not None:
        window, mask = blob
        depth[window][mask] = np.inf
        part[window][mask] = NO_PART


def cut_low(depth: Floats32, part: Bytes, row: int) -> None:
    """Everything below an image row is gone (a floor cut too high, a table's edge)."""
    depth[row:] = np.inf
    part[row:] = NO_PART
