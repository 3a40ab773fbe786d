"""Simple meshes of things: boxes and tubes. Room axes, metres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from teleop.people.body import Ints32
from teleop.people.rig import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """vertices_m (V, 3), faces (F, 3)."""

    vertices_m: Floats
    faces: Ints32

    def moved(self, x_m: float, z_m: float) -> Mesh:
        """The same thing elsewhere on the floor."""
        return Mesh(self.vertices_m + np.array([x_m, 0.0, z_m]), self.faces)


def joined(meshes: list[Mesh]) -> Mesh:
    """Many meshes as one."""
    starts = np.cumsum([0] + [len(m.vertices_m) for m in meshes])
    faces = [m.faces + start for m, start in zip(meshes, starts[:-1], strict=True)]
    return Mesh(np.concatenate([m.vertices_m for m in meshes]), np.concatenate(faces).astype(np.int32))


def tube(centres: Floats, radii: Floats, around: int = 20) -> Mesh:
    """A closed tube through horizontal ellipses: centres (R, 3), radii (R, 2) across x and z."""
    angle = np.linspace(0, 2 * np.pi, around, endpoint=False)
    ring = np.stack([np.cos(angle), np.zeros(around), np.sin(angle)], axis=1)
    points = centres[:, None, :] + ring * np.stack([radii[:, 0], 0 * radii[:, 0], radii[:, 1]], axis=1)[:, None, :]
    rows = len(centres)
    i, k = np.meshgrid(np.arange(rows - 1), np.arange(around), indexing="ij")
    a, b = i * around + k, i * around + (k + 1) % around
    sides = np.stack([a, b, b + around, a, b + around, a + around], axis=-1).reshape(-1, 3)
    ends = [np.stack([np.full(around - 2, s), s + np.arange(1, around - 1), s + np.arange(2, around)], axis=-1)
            for s in (0, (rows - 1) * around)]  # fmt: skip
    return Mesh(points.reshape(-1, 3), np.concatenate([sides, *ends]).astype(np.int32))


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> Mesh:
    """An upright box."""
    corners = np.array([[(low, high)[(i >> a) & 1][a] for a in range(3)] for i in range(8)])
    quads = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
    return Mesh(corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], np.int32))


def upright_tube(rows: tuple[tuple[float, float, float], ...]) -> Mesh:
    """A closed tube about the vertical; rows: height, radius across x and along z."""
    r = np.array(rows)
    return tube(np.stack([0 * r[:, 0], r[:, 0], 0 * r[:, 0]], axis=1), r[:, 1:])
