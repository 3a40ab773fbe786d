"""Primitives to triangle meshes, one per colour: a renderer draws a dozen bodies instead of hundreds."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
import numpy.typing as npt

from robot_sim.primitives import Primitive, Rgba, Vec3, rotation

F64 = npt.NDArray[np.float64]
SIDES = 8
RINGS = 6


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Triangles of one colour in world axes. vertices_m, normals: (V, 3); triangles: (T, 3) vertex numbers."""

    rgba: Rgba
    vertices_m: F64
    normals: F64
    triangles: npt.NDArray[np.int32]


def merge(parts: Iterable[Primitive]) -> list[Mesh]:
    """All primitives as one mesh per colour, in the order in which the colours first appear."""
    by_colour: dict[Rgba, list[Primitive]] = {}
    for part in parts:
        by_colour.setdefault(part.rgba, []).append(part)
    meshes = []
    for rgba, group in by_colour.items():
        vertices, normals, triangles = [], [], []
        offset = 0
        for part in group:
            v, n, t = tessellate(part)
            vertices.append(v)
            normals.append(n)
            triangles.append(t + offset)
            offset += len(v)
        meshes.append(Mesh(rgba, np.concatenate(vertices), np.concatenate(normals), np.concatenate(triangles)))
    return meshes


def tessellate(part: Primitive) -> tuple[F64, F64, npt.NDArray[np.int32]]:
    """Vertices (V, 3), outward normals (V, 3) and triangles (T, 3) of one primitive in world axes."""
    if part.kind == "box":
        faces = _box(*part.size_m)
    elif part.kind == "cylinder":
        faces = _cylinder(*part.size_m)
    else:
        faces = _sphere(*part.size_m)
    vertices: list[Vec3] = []
    normals: list[Vec3] = []
    triangles: list[tuple[int, int, int]] = []
    for corners, face_normals in faces:
        start = len(vertices)
        vertices += corners
        normals += face_normals
        triangles += [(start, start + k, start + k + 1) for k in range(1, len(corners) - 1)]
    R = rotation(part.rpy_rad)
    v = np.array(vertices, dtype=np.float64) @ R.T + np.array(part.xyz_m)
    n = np.array(normals, dtype=np.float64) @ R.T
    return v, n / np.linalg.norm(n, axis=1, keepdims=True), np.array(triangles, dtype=np.int32)


Face = tuple[list[Vec3], list[Vec3]]
"""A convex polygon, counter-clockwise from outside: corners and their normals."""


def _box(x: float, y: float, z: float) -> list[Face]:
    half = (0.5 * x, 0.5 * y, 0.5 * z)
    faces: list[Face] = []
    for axis in range(3):
        a, b = (axis + 1) % 3, (axis + 2) % 3
        for sign in (1.0, -1.0):
            corners = []
            for sa, sb in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                corner = [0.0, 0.0, 0.0]
                corner[axis], corner[a], corner[b] = sign * half[axis], sign * sa * half[a], sb * half[b]
                corners.append((corner[0], corner[1], corner[2]))
            normal = (sign * (axis == 0), sign * (axis == 1), sign * (axis == 2))
            faces.append((corners, [normal] * 4))
    return faces


def _cylinder(radius: float, length: float) -> list[Face]:
    around = [(cos(2 * pi * k / SIDES), sin(2 * pi * k / SIDES)) for k in range(SIDES)]
    h = 0.5 * length
    faces: list[Face] = []
    for (c0, s0), (c1, s1) in zip(around, around[1:] + around[:1], strict=True):
        p0, p1 = (radius * c0, radius * s0), (radius * c1, radius * s1)
        corners = [(*p0, -h), (*p1, -h), (*p1, h), (*p0, h)]
        faces.append((corners, [(c0, s0, 0.0), (c1, s1, 0.0), (c1, s1, 0.0), (c0, s0, 0.0)]))
    rim = [(radius * c, radius * s) for c, s in around]
    faces.append(([(*p, h) for p in rim], [(0.0, 0.0, 1.0)] * SIDES))
    faces.append(([(*p, -h) for p in reversed(rim)], [(0.0, 0.0, -1.0)] * SIDES))
    return faces


def _sphere(radius: float) -> list[Face]:
    def at(ring: int, k: int) -> Vec3:
        polar, azimuth = pi * ring / RINGS, 2 * pi * (k % SIDES) / SIDES
        return (sin(polar) * cos(azimuth), sin(polar) * sin(azimuth), cos(polar))

    faces: list[Face] = []
    for ring in range(RINGS):
        for k in range(SIDES):
            quad = [at(ring, k), at(ring + 1, k), at(ring + 1, k + 1), at(ring, k + 1)]
            # at the poles two corners fall together
            unit = quad[:3] if ring == 0 else [quad[0], quad[1], quad[3]] if ring == RINGS - 1 else quad
            faces.append(([(radius * x, radius * y, radius * z) for x, y, z in unit], unit))
    return faces
