"""A person's skin: mesh, weights and part labels at rest, and linear blend skinning."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt

from teleop.people.rig import Floats, Posed, Rig

Floats32 = npt.NDArray[np.float32]
Ints32 = npt.NDArray[np.int32]
Bytes = npt.NDArray[np.uint8]


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """One person at rest.

    vertices_m: (V, 3) float32. normals: (V, 3) float32 unit. faces: (F, 3) int32, counter-clockwise from outside.
    bone: (V, 4) int32 and weight: (V, 4) float32, rows sum to 1. face_part: (F,) uint8 (teleop.body.parts).
    vertex_bone: (V,) int32 the bone of largest weight. height_m: crown to sole.
    """

    rig: Rig
    vertices_m: Floats32
    normals: Floats32
    faces: Ints32
    bone: Ints32
    weight: Floats32
    face_part: Bytes
    vertex_bone: Ints32
    height_m: float


@numba.njit(cache=True, nogil=True)
def _skin(vertices: Floats32, bone: Ints32, weight: Floats32, A: Floats32, out: Floats32) -> None:
    for i in range(vertices.shape[0]):
        x, y, z = vertices[i, 0], vertices[i, 1], vertices[i, 2]
        a = np.float32(0.0)
        b = np.float32(0.0)
        c = np.float32(0.0)
        for k in range(4):
            w = weight[i, k]
            if w == 0.0:
                break
            M = A[bone[i, k]]
            a += w * (M[0, 0] * x + M[0, 1] * y + M[0, 2] * z + M[0, 3])
            b += w * (M[1, 0] * x + M[1, 1] * y + M[1, 2] * z + M[1, 3])
            c += w * (M[2, 0] * x + M[2, 1] * y + M[2, 2] * z + M[2, 3])
        out[i, 0], out[i, 1], out[i, 2] = a, b, c


def bone_matrices(rig: Rig, posed: Posed) -> Floats32:
    """Affine matrices (55, 3, 4) float32 that carry rest points with each bone."""
    t = posed.p_m - np.einsum("bij,bj->bi", posed.R, rig.head_m)
    return np.concatenate([posed.R, t[:, :, None]], axis=2).astype(np.float32)


def skin(body: Body, posed: Posed, vertices_m: Floats32 | None = None) -> Floats32:
    """Posed vertices (V, 3) float32 by linear blend skinning; vertices_m replaces the rest skin (clothes)."""
    rest = body.vertices_m if vertices_m is None else vertices_m
    out = np.empty_like(rest)
    _skin(rest, body.bone, body.weight, bone_matrices(body.rig, posed), out)
    return out


@numba.njit(cache=True, nogil=True)
def _normals(vertices: Floats32, faces: Ints32, out: Floats32) -> None:
    out[:] = 0.0
    for f in range(faces.shape[0]):
        i, j, k = faces[f, 0], faces[f, 1], faces[f, 2]
        ax, ay, az = vertices[j, 0] - vertices[i, 0], vertices[j, 1] - vertices[i, 1], vertices[j, 2] - vertices[i, 2]
        bx, by, bz = vertices[k, 0] - vertices[i, 0], vertices[k, 1] - vertices[i, 1], vertices[k, 2] - vertices[i, 2]
        nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        for m in (i, j, k):
            out[m, 0] += nx
            out[m, 1] += ny
            out[m, 2] += nz
    for m in range(out.shape[0]):
        n = np.sqrt(out[m, 0] ** 2 + out[m, 1] ** 2 + out[m, 2] ** 2)
        if n > 0.0:
            out[m] /= n


def vertex_normals(vertices_m: Floats32, faces: Ints32) -> Floats32:
    """Unit normals (V, 3) out of the skin, area-weighted over the faces round each vertex."""
    out = np.empty_like(vertices_m)
    _normals(vertices_m, faces, out)
    return out


def strongest(weights: Floats, n: int = 4) -> tuple[Ints32, Floats32]:
    """The n largest of dense weights (V, 55): bone (V, n) and weight (V, n), largest first, rows sum to 1."""
    order = np.argsort(-weights, axis=1, kind="stable")[:, :n]
    w = np.take_along_axis(weights, order, axis=1)
    w /= w.sum(axis=1, keepdims=True)
    return order.astype(np.int32), w.astype(np.float32)
