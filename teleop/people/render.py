"""A z-buffer: triangles to depth and face index, one pixel centre at a time. Everything in camera axes, metres."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt

from teleop.frames import Camera
from teleop.people.body import Floats32, Ints32

NEAR_M = 0.25
"""Triangles that reach nearer than this to the camera plane are left out."""


@dataclass(frozen=True, slots=True, eq=False)
class Raster:
    """depth_m: (H, W) float32, inf where nothing is. face: (H, W) int32, -1 where nothing is."""

    depth_m: Floats32
    face: Ints32


def empty_raster(camera: Camera) -> Raster:
    """A raster with nothing drawn yet."""
    size = (camera.depth.height, camera.depth.width)
    return Raster(np.full(size, np.inf, np.float32), np.full(size, -1, np.int32))


@numba.njit(cache=True, nogil=True)
def _project(points: Floats32, k: npt.NDArray[np.float64], out: Floats32) -> None:
    for i in range(points.shape[0]):
        z = points[i, 2]
        if z > NEAR_M:
            out[i, 0] = k[2] + k[0] * points[i, 0] / z
            out[i, 1] = k[3] - k[1] * points[i, 1] / z
            out[i, 2] = 1.0 / z
        else:
            out[i, 2] = 0.0


@numba.njit(cache=True, nogil=True)
def _fill(uvw: Floats32, faces: Ints32, first_face: int, depth: Floats32, face: Ints32) -> None:
    height, width = depth.shape
    for f in range(faces.shape[0]):
        a, b, c = faces[f, 0], faces[f, 1], faces[f, 2]
        wa, wb, wc = uvw[a, 2], uvw[b, 2], uvw[c, 2]
        if wa == 0.0 or wb == 0.0 or wc == 0.0:
            continue
        ua, va, ub, vb, uc, vc = uvw[a, 0], uvw[a, 1], uvw[b, 0], uvw[b, 1], uvw[c, 0], uvw[c, 1]
        area = (ub - ua) * (vc - va) - (uc - ua) * (vb - va)
        if area == 0.0:
            continue
        u0 = max(0, int(np.ceil(min(ua, ub, uc))))
        u1 = min(width - 1, int(np.floor(max(ua, ub, uc))))
        v0 = max(0, int(np.ceil(min(va, vb, vc))))
        v1 = min(height - 1, int(np.floor(max(va, vb, vc))))
        inv = np.float32(1.0) / area
        # Barycentric weights and 1/z are affine in (u, v).
        bu, bv = (vc - va) * inv, -(uc - ua) * inv
        cu, cv = -(vb - va) * inv, (ub - ua) * inv
        for v in range(v0, v1 + 1):
            for u in range(u0, u1 + 1):
                du, dv = u - ua, v - va
                lb = du * bu + dv * bv
                lc = du * cu + dv * cv
                if lb < -1e-4 or lc < -1e-4 or lb + lc > 1.0001:
                    continue
                z = np.float32(1.0) / (wa + lb * (wb - wa) + lc * (wc - wa))
                if z < depth[v, u]:
                    depth[v, u] = z
                    face[v, u] = first_face + f


def camera_vector(camera: Camera) -> npt.NDArray[np.float64]:
    """Signed fx, fy, cx, cy: u = cx + fx x / z, v = cy - fy y / z."""
    k = camera.depth
    return np.array([camera.x_sign * k.fx, k.fy, k.cx, k.cy])


def draw(raster: Raster, camera: Camera, points_m: Floats32, faces: Ints32, first_face: int = 0) -> None:
    """Draw triangles (F, 3) over points (V, 3) into the raster; face f is written as first_face + f."""
    uvw = np.empty_like(points_m)
    _project(points_m, camera_vector(camera), uvw)
    _fill(uvw, faces, first_face, raster.depth_m, raster.face)
