"""Colour: the z-buffer's faces lit by one lamp and the sky, as a camera with noise sees them."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numba
import numpy as np
import numpy.typing as npt

from teleop.frames import Camera, ColorImage
from teleop.people.body import Floats32, Ints32
from teleop.people.pose import unit
from teleop.people.render import Raster, camera_vector
from teleop.people.room import Room
from teleop.people.view import View


@dataclass(frozen=True, slots=True)
class Light:
    """level: exposure, 1 normal. towards: to the lamp, room axes. rgb: its tint. noise: of the camera, in 255ths."""

    level: float = 1.0
    towards: tuple[float, float, float] = (0.3, 0.8, -0.7)
    rgb: tuple[float, float, float] = (1.0, 1.0, 1.0)
    noise: float = 3.0


def random_light(rng: np.random.Generator) -> Light:
    """Dim to bright (0.55-1.15), warm to cold, from anywhere above."""
    x, y, z = rng.normal(0, 0.6), rng.uniform(0.3, 1.0), -rng.uniform(0.1, 1.0)
    warm = rng.normal(0, 0.04)
    rgb = (1 + warm, 1.0, 1 - warm)
    return Light(float(rng.uniform(0.55, 1.15)), (float(x), float(y), float(z)), rgb, float(rng.uniform(1.5, 5.0)))


@numba.njit(cache=True, nogil=True)
def _shade(
    k: npt.NDArray[np.float64],
    depth: Floats32,
    face: Ints32,
    points: Floats32,
    normals: Floats32,
    faces: Ints32,
    rgb: Floats32,
    lamp: npt.NDArray[np.float64],
    out: Floats32,
) -> None:
    height, width = depth.shape
    for v in range(height):
        for u in range(width):
            f = face[v, u]
            if f < 0:
                continue
            z = depth[v, u]
            x, y = (u - k[2]) / k[0] * z, -(v - k[3]) / k[1] * z
            a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
            wa = 1.0 / ((x - points[a, 0]) ** 2 + (y - points[a, 1]) ** 2 + (z - points[a, 2]) ** 2 + 1e-7)
            wb = 1.0 / ((x - points[b, 0]) ** 2 + (y - points[b, 1]) ** 2 + (z - points[b, 2]) ** 2 + 1e-7)
            wc = 1.0 / ((x - points[c, 0]) ** 2 + (y - points[c, 1]) ** 2 + (z - points[c, 2]) ** 2 + 1e-7)
            s = 1.0 / (wa + wb + wc)
            nx = (wa * normals[a, 0] + wb * normals[b, 0] + wc * normals[c, 0]) * s
            ny = (wa * normals[a, 1] + wb * normals[b, 1] + wc * normals[c, 1]) * s
            nz = (wa * normals[a, 2] + wb * normals[b, 2] + wc * normals[c, 2]) * s
            n = np.sqrt(nx * nx + ny * ny + nz * nz) + 1e-9
            lit = (nx * lamp[0] + ny * lamp[1] + nz * lamp[2]) / n
            light = 0.55 + 0.12 * ny / n + 0.38 * max(lit, 0.0)
            for i in range(3):
                out[v, u, i] = light * (wa * rgb[a, i] + wb * rgb[b, i] + wc * rgb[c, i]) * s


@numba.njit(cache=True, nogil=True)
def _shade_planes(
    k: npt.NDArray[np.float64],
    depth: Floats32,
    face: Ints32,
    R: npt.NDArray[np.float64],
    t: npt.NDArray[np.float64],
    rgb: npt.NDArray[np.float64],
    strength: npt.NDArray[np.float64],
    out: Floats32,
) -> None:
    height, width = depth.shape
    for v in range(height):
        for u in range(width):
            p = -2 - face[v, u]
            if p < 0:
                continue
            z = depth[v, u]
            cx, cy, cz = (u - k[2]) / k[0] * z - t[0], -(v - k[3]) / k[1] * z - t[1], z - t[2]
            x = R[0, 0] * cx + R[1, 0] * cy + R[2, 0] * cz
            y = R[0, 1] * cx + R[1, 1] * cy + R[2, 1] * cz
            w = R[0, 2] * cx + R[1, 2] * cy + R[2, 2] * cz
            pattern = np.sin(9.0 * x + 1.3 * np.sin(5.0 * w)) * np.sin(8.0 * w + 3.0 * y)
            light = 0.9 * (1.0 + 0.35 * strength[p] * pattern)
            for i in range(3):
                out[v, u, i] = light * rgb[p, i]


def shade(
    raster: Raster,
    camera: Camera,
    view: View,
    room: Room | None,
    points_m: Floats32,
    normals: Floats32,
    faces: Ints32,
    rgb: Floats32,
    light: Light,
    rng: np.random.Generator,
) -> ColorImage:
    """Colour image (H, W, 3) uint8 RGB, registered to depth. points_m, normals, rgb (0..255): (V, 3) in camera axes."""
    out = np.full((*raster.depth_m.shape, 3), 90.0, np.float32)
    k = camera_vector(camera)
    if room is not None:
        _shade_planes(k, raster.depth_m, raster.face, view.R, view.t_m, room.plane_rgb, room.plane_texture, out)
    lamp = view.R @ unit(np.array(light.towards))
    _shade(k, raster.depth_m, raster.face, points_m, normals, faces, rgb, lamp, out)
    out *= np.array(light.rgb, np.float32) * np.float32(light.level)
    out += rng.standard_normal(out.shape, np.float32) * np.float32(2.0 * light.noise)
    smooth = np.asarray(cv2.GaussianBlur(out, (0, 0), 0.7), np.float32)
    return np.clip(smooth, 0, 255).astype(np.uint8)
