"""The depth sensor: what a Kinect v1 makes of true depth.

Nguyen, Izadi and Lovell 2012 (axial and lateral noise), Khoshelham and Elberink 2012 (disparity steps):
``sigma_z = 0.0012 + 0.0019 (z - 0.4)^2`` m, lateral 0.8 px at 640 columns, disparity steps of z^2 / 351.3 m,
an infrared shadow of ``f 0.075 (1/z_near - 1/z_far)`` px, drop-outs where the surface is seen at a grazing angle.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numba
import numpy as np

from teleop.frames import Camera, DepthImage
from teleop.people.body import Floats32, Ints32


@dataclass(frozen=True, slots=True)
class SensorModel:
    """lateral_px: at 640 columns. axial: factor on sigma_z. base_m: projector to camera.

    grazing_rad: where drop-outs begin."""

    lateral_px: float = 0.8
    axial: float = 1.0
    base_m: float = 0.075
    grazing_rad: float = 1.35
    near_m: float = 0.5
    far_m: float = 8.0
    quantised: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Reading:
    """depth_mm: (H, W) uint16, 0 = nothing. source: (H, W) int32, flat index of the pixel whose surface was read."""

    depth_mm: DepthImage
    source: Ints32


@numba.njit(cache=True, nogil=True)
def _sense(
    depth: Floats32,
    du: Floats32,
    dv: Floats32,
    axial: Floats32,
    chance: Floats32,
    focal_px: float,
    model: tuple[float, float, float, float, float, bool],
    mirrored: bool,
    first: tuple[int, int, int],
    out: DepthImage,
    source: Ints32,
) -> None:
    scale_z, base_m, grazing, near_m, far_m, quantised = model
    height, width = depth.shape
    for v in range(height):
        least = 1e9
        for step in range(width):
            # The projector stands at the camera's own right: scan so that what shades comes before what is shaded.
            u = step if mirrored else width - 1 - step
            z_true = depth[v, u]
            shaded = False
            if z_true < 50.0:
                at = (first[1] + u) * (-1.0 if mirrored else 1.0) - focal_px * base_m / z_true
                shaded = at > least + 0.5
                least = min(least, at)
            su = min(max(u + int(np.rint(du[v, u])), 0), width - 1)
            sv = min(max(v + int(np.rint(dv[v, u])), 0), height - 1)
            z = depth[sv, su]
            if shaded or not (near_m < z < far_m):
                out[v, u] = 0
                continue
            slope = 0.0
            if 0 < su < width - 1 and 0 < sv < height - 1:
                gu = 0.5 * (depth[sv, su + 1] - depth[sv, su - 1])
                gv = 0.5 * (depth[sv + 1, su] - depth[sv - 1, su])
                slope = np.sqrt(gu * gu + gv * gv) * focal_px / z
            if np.isfinite(slope) and slope < 40.0:
                angle = np.arctan(slope)
                if angle > grazing and chance[v, u] < 0.6 * (1.0 - np.cos(angle)):
                    out[v, u] = 0
                    continue
            z += axial[v, u] * scale_z * (0.0012 + 0.0019 * (z - 0.4) ** 2)
            if quantised:
                z = 351.3 / np.rint(351.3 / z)
            source[v, u] = (first[0] + sv) * first[2] + first[1] + su
            out[v, u] = np.uint16(min(max(z * 1000.0 + 0.5, 0.0), 65535.0))


def sense(depth_m: Floats32, camera: Camera, rng: np.random.Generator, model: SensorModel | None = None) -> Reading:
    """What the sensor reads of true depth (H, W) float32 metres, inf where nothing is."""
    model = model or SensorModel()
    out, source = np.zeros(depth_m.shape, np.uint16), np.zeros(depth_m.shape, np.int32)
    rows = np.flatnonzero(np.isfinite(depth_m).any(axis=1))
    if not len(rows):
        return Reading(out, source)
    columns = np.flatnonzero(np.isfinite(depth_m).any(axis=0))
    v0, v1 = max(0, rows[0] - 3), min(depth_m.shape[0], rows[-1] + 4)
    u0, u1 = max(0, columns[0] - 3), min(depth_m.shape[1], columns[-1] + 4)
    size = (v1 - v0, u1 - u0)
    scale = camera.depth.width / 640
    # Block matching makes the lateral error of neighbours alike: noise of half resolution, enlarged.
    coarse = (int(size[0] / (2 * scale)) + 2, int(size[1] / (2 * scale)) + 2)
    jitter = [
        cv2.resize(rng.standard_normal(coarse, np.float32), size[::-1], interpolation=cv2.INTER_LINEAR)
        * np.float32(1.3 * model.lateral_px * max(scale, 0.6))
        for _ in range(2)
    ]
    axial = rng.standard_normal(size, np.float32)
    chance = rng.random(size, np.float32)
    settings = (model.axial, model.base_m, model.grazing_rad, model.near_m, model.far_m, model.quantised)
    window = (slice(v0, v1), slice(u0, u1))
    first, focal = (int(v0), int(u0), depth_m.shape[1]), camera.depth.fx
    noise = (jitter[0], jitter[1], axial, chance)
    _sense(depth_m[window], *noise, focal, settings, camera.mirrored, first, out[window], source[window])
    return Reading(out, source)
