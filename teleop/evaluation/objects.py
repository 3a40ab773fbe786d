"""Things that stand in rooms and are no people: boxes, chairs, tables, plants, a coat on a stand. Room axes, metres."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from teleop.people.body import Floats32, Ints32
from teleop.people.rig import Floats
from teleop.people.room import Room


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """vertices_m (V, 3), faces (F, 3)."""

    vertices_m: Floats
    faces: Ints32


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


def _upright_tube(rows: tuple[tuple[float, float, float], ...]) -> Mesh:
    r = np.array(rows)
    return tube(np.stack([0 * r[:, 0], r[:, 0], 0 * r[:, 0]], axis=1), r[:, 1:])


def chair(rng: np.random.Generator) -> Mesh:
    """A chair with or without a tall back."""
    seat, back = float(rng.uniform(0.4, 0.5)), float(rng.uniform(0.8, 1.25))
    legs = [box((x - 0.02, 0, z - 0.02), (x + 0.02, seat, z + 0.02)) for x in (-0.2, 0.2) for z in (-0.2, 0.2)]
    return joined([*legs, box((-0.23, seat, -0.23), (0.23, seat + 0.05, 0.23)),
                   box((-0.22, seat, 0.18), (0.22, back, 0.23))])  # fmt: skip


def table(rng: np.random.Generator) -> Mesh:
    """A table, sometimes with things on it."""
    w, d, h = float(rng.uniform(0.35, 0.7)), float(rng.uniform(0.3, 0.45)), float(rng.uniform(0.65, 0.95))
    parts = [box((-w, h - 0.03, -d), (w, h, d))]
    parts += [
        box((x - 0.03, 0, z - 0.03), (x + 0.03, h, z + 0.03))
        for x in (0.05 - w, w - 0.05)
        for z in (0.05 - d, d - 0.05)
    ]
    for _ in range(int(rng.integers(0, 4))):
        x, z, s = rng.uniform(-w, w), rng.uniform(-d, d), rng.uniform(0.05, 0.15)
        parts.append(box((x - s, h, z - s), (x + s, h + float(rng.uniform(0.1, 0.5)), z + s)))
    return joined(parts)


def plant(rng: np.random.Generator) -> Mesh:
    """A pot with a bush of leaves, up to a person's height."""
    height, count = float(rng.uniform(0.8, 1.9)), int(rng.integers(60, 160))
    spread = float(rng.uniform(0.1, 0.24))
    at = np.stack([rng.normal(0, spread, count), rng.uniform(0.3, height, count), rng.normal(0, spread, count)], axis=1)
    d = rng.normal(0, 1, (count, 3)) + np.array([0, 0.3, 0])
    d *= rng.uniform(0.1, 0.28, (count, 1)) / np.linalg.norm(d, axis=1, keepdims=True)
    across = np.cross(d, rng.normal(0, 1, (count, 3)))
    across *= rng.uniform(0.03, 0.07) / np.linalg.norm(across, axis=1, keepdims=True)
    leaf = np.stack([at, at + d / 2 + across, at + d, at + d / 2 - across], axis=1).reshape(-1, 3)
    base = 4 * np.arange(count)[:, None]
    faces = np.concatenate([base + np.array([0, 1, 2]), base + np.array([0, 2, 3])]).astype(np.int32)
    pot = _upright_tube(((0.0, 0.1, 0.1), (0.3, 0.16, 0.16)))
    stem = _upright_tube(((0.3, 0.015, 0.015), (height, 0.01, 0.01)))
    return joined([Mesh(leaf, faces), pot, stem])


def coat_stand(rng: np.random.Generator) -> Mesh:
    """A pole with a coat on a hanger, half of the time with a hat on top."""
    shoulder, hem = float(rng.uniform(1.3, 1.65)), float(rng.uniform(0.4, 0.9))
    wide, deep = float(rng.uniform(0.19, 0.25)), float(rng.uniform(0.07, 0.13))
    flare = float(rng.uniform(0.8, 1.2))
    coat = _upright_tube(
        (
            (hem, wide * flare, deep * 1.2),
            ((hem + shoulder) / 2, wide * 0.9, deep),
            (shoulder - 0.12, wide, deep),
            (shoulder, 0.55 * wide, 0.6 * deep),
            (shoulder + 0.06, 0.07, 0.06),
        )
    )
    top = shoulder + float(rng.uniform(0.12, 0.3))
    parts = [
        coat,
        _upright_tube(((0.0, 0.2, 0.2), (0.03, 0.2, 0.2))),
        _upright_tube(((0.0, 0.02, 0.02), (top, 0.02, 0.02))),
    ]
    for sign in (-1.0, 1.0):
        x = sign * (wide + 0.02)
        high, low = np.array([0.8 * x, shoulder - 0.06, 0]), np.array([1.1 * x, shoulder - 0.6, 0])
        centres = high + np.linspace(0, 1, 5)[:, None] * (low - high)
        parts.append(tube(centres, np.full((5, 2), 0.06)))
    if rng.uniform() < 0.5:
        parts.append(
            _upright_tube(
                ((top - 0.02, 0.15, 0.15), (top, 0.15, 0.15), (top + 0.01, 0.09, 0.09), (top + 0.1, 0.08, 0.08))
            )
        )
    return joined(parts)


def cupboard(rng: np.random.Generator) -> Mesh:
    """A box up to a person's size or more."""
    w, d, h = float(rng.uniform(0.12, 0.5)), float(rng.uniform(0.1, 0.3)), float(rng.uniform(0.5, 2.0))
    return box((-w, 0.0, -d), (w, h, d))


def ladder(rng: np.random.Generator) -> Mesh:
    """A folding ladder: bars and steps."""
    h, w = float(rng.uniform(1.2, 1.9)), float(rng.uniform(0.2, 0.3))
    bars = []
    for sign in (-1.0, 1.0):
        foot, head = np.array([sign * w, 0.0, 0.0]), np.array([sign * 0.7 * w, h, 0.3])
        bars.append(tube(foot + np.linspace(0, 1, 8)[:, None] * (head - foot), np.full((8, 2), 0.03)))
    for t in np.linspace(0.15, 0.95, 6):
        y, z, half = t * h, 0.3 * t, w * (1 - 0.3 * t)
        bars.append(box((-half, y - 0.015, z - 0.05), (half, y + 0.015, z + 0.05)))
    return joined(bars)


KINDS: Final[dict[str, Callable[[np.random.Generator], Mesh]]] = {
    "chair": chair,
    "table": table,
    "plant": plant,
    "coat on a stand": coat_stand,
    "cupboard": cupboard,
    "ladder": ladder,
}


def furnished(room: Room, mesh: Mesh, x_m: float, z_m: float, turn_rad: float) -> Room:
    """The room with one more thing at (x, z), turned about the vertical."""
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    R = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    points: Floats32 = (mesh.vertices_m @ R.T + np.array([x_m, 0.0, z_m])).astype(np.float32)
    count = len(room.vertices_m)
    return replace(
        room,
        vertices_m=np.concatenate([room.vertices_m, points]),
        faces=np.concatenate([room.faces, mesh.faces + count]).astype(np.int32),
        face_rgb=np.concatenate([room.face_rgb, np.full((len(mesh.faces), 3), 130.0)]),
    )
