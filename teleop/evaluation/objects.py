"""Things that stand in rooms and are no people: boxes, chairs, tables, plants, a coat on a stand. Room axes, metres."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from teleop.people.meshes import Mesh, box, joined, tube, upright_tube


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
    pot = upright_tube(((0.0, 0.1, 0.1), (0.3, 0.16, 0.16)))
    stem = upright_tube(((0.3, 0.015, 0.015), (height, 0.01, 0.01)))
    return joined([Mesh(leaf, faces), pot, stem])


def coat_stand(rng: np.random.Generator) -> Mesh:
    """A pole with a coat on a hanger, half of the time with a hat on top."""
    shoulder, hem = float(rng.uniform(1.3, 1.65)), float(rng.uniform(0.4, 0.9))
    wide, deep = float(rng.uniform(0.19, 0.25)), float(rng.uniform(0.07, 0.13))
    flare = float(rng.uniform(0.8, 1.2))
    coat = upright_tube(
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
        upright_tube(((0.0, 0.2, 0.2), (0.03, 0.2, 0.2))),
        upright_tube(((0.0, 0.02, 0.02), (top, 0.02, 0.02))),
    ]
    for sign in (-1.0, 1.0):
        x = sign * (wide + 0.02)
        high, low = np.array([0.8 * x, shoulder - 0.06, 0]), np.array([1.1 * x, shoulder - 0.6, 0])
        centres = high + np.linspace(0, 1, 5)[:, None] * (low - high)
        parts.append(tube(centres, np.full((5, 2), 0.06)))
    if rng.uniform() < 0.5:
        parts.append(
            upright_tube(
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
