"""Things of every kind round an operator, for training: no two alike, and none of the evaluation's own things.

Boxes, beds, benches, garments on stands, bushes, sacks, bars: what a segmentation takes along by mistake, and what a
tracker must not take for a person. Each stands on the floor round the origin, room axes, metres.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from teleop.people.meshes import Mesh, box, joined, tube, upright_tube
from teleop.people.rig import Floats

Rng = np.random.Generator


def _turned(mesh: Mesh, R: Floats) -> Mesh:
    return Mesh(mesh.vertices_m @ R.T, mesh.faces)


def _about_y(angle_rad: float) -> Floats:
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def _bar(a: Floats, b: Floats, radius_m: float) -> Mesh:
    """A thin round bar from a to b (tubes are ringed horizontally, which does for bars that are not level)."""
    share = np.linspace(0, 1, 4)[:, None]
    return tube(a + share * (b - a), np.full((4, 2), radius_m), around=8)


def _legs(half_x: float, half_z: float, height: float, radius: float) -> list[Mesh]:
    return [box((x - radius, 0, z - radius), (x + radius, height, z + radius))
            for x in (-half_x, half_x) for z in (-half_z, half_z)]  # fmt: skip


def slab(rng: Rng) -> Mesh:
    """A bed, bench, desk or trolley: a top on legs, or down to the floor, with things on it."""
    half_x, half_z = float(rng.uniform(0.2, 1.0)), float(rng.uniform(0.15, 0.5))
    high, thick = float(rng.uniform(0.3, 1.05)), float(rng.uniform(0.02, 0.2))
    parts = [box((-half_x, high - thick, -half_z), (half_x, high, half_z))]
    if rng.uniform() < 0.6:
        parts += _legs(0.9 * half_x, 0.9 * half_z, high - thick, float(rng.uniform(0.015, 0.05)))
    else:
        parts.append(box((-0.95 * half_x, 0.0, -0.95 * half_z), (0.95 * half_x, high - thick, 0.95 * half_z)))
    if rng.uniform() < 0.4:  # a headboard, a screen, a back
        z = half_z * float(rng.choice([-1.0, 1.0]))
        parts.append(box((-half_x, high, z - 0.02), (half_x, high + float(rng.uniform(0.1, 0.7)), z + 0.02)))
    for _ in range(int(rng.integers(0, 5))):
        x, z = float(rng.uniform(-half_x, half_x)), float(rng.uniform(-half_z, half_z))
        w, h = float(rng.uniform(0.03, 0.16)), float(rng.uniform(0.04, 0.45))
        parts.append(
            box((x - w, high, z - w), (x + w, high + h, z + w))
            if rng.uniform() < 0.5
            else upright_tube(((high, w, w), (high + 0.7 * h, w, w), (high + h, 0.5 * w, 0.5 * w))).moved(x, z)
        )
    return joined(parts)


def seat(rng: Rng) -> Mesh:
    """A stool, chair or armchair."""
    high, half = float(rng.uniform(0.38, 0.75)), float(rng.uniform(0.16, 0.32))
    parts = [box((-half, high - 0.05, -half), (half, high, half))]
    if rng.uniform() < 0.5:
        parts += _legs(0.9 * half, 0.9 * half, high, 0.02)
    else:
        parts.append(upright_tube(((0.0, 0.9 * half, 0.9 * half), (0.05, 0.04, 0.04), (high, 0.04, 0.04))))
    if rng.uniform() < 0.75:
        top = high + float(rng.uniform(0.25, 0.85))
        if rng.uniform() < 0.5:
            parts.append(box((-half, high, half - 0.05), (half, top, half + 0.05)))
        else:
            parts += [box((x - 0.02, high, half - 0.02), (x + 0.02, top, half + 0.02)) for x in (-half, 0.0, half)]
    if rng.uniform() < 0.4:
        parts += [box((x - 0.04, high, -half), (x + 0.04, high + 0.22, half)) for x in (-half, half)]
    return joined(parts)


def garment(rng: Rng) -> Mesh:
    """A coat, overall or dress on a hanger, a stand or a hook, with or without sleeves, hat, boots."""
    shoulder, length = float(rng.uniform(1.15, 1.8)), float(rng.uniform(0.4, 1.15))
    wide, deep = float(rng.uniform(0.16, 0.28)), float(rng.uniform(0.03, 0.15))
    rows = 9
    down, noise = np.linspace(0, 1, rows), rng.normal(0, 1, rows)
    shape = np.interp(down, (0.0, 0.08, 0.5, 1.0), (0.35, 0.95, rng.uniform(0.75, 1.1), rng.uniform(0.8, 1.5)))
    profile = (1.0 + 0.12 * noise) * shape
    sway = np.cumsum(rng.normal(0, 0.012, (rows, 2)), axis=0)
    centres = np.stack([sway[:, 0], shoulder - length * down, sway[:, 1]], axis=1)
    cloth = tube(centres[::-1], np.stack([wide * profile, deep * (0.6 + 0.6 * rng.uniform(0, 1, rows))], axis=1)[::-1])
    parts = [cloth]
    if rng.uniform() < 0.7:
        for sign in (-1.0, 1.0):
            top = np.array([sign * wide * 0.85, shoulder - 0.07, 0.0])
            end = top + np.array([sign * rng.uniform(0.0, 0.15), -rng.uniform(0.35, 0.65), rng.normal(0, 0.05)])
            parts.append(
                tube(end + np.linspace(0, 1, 5)[:, None] * (top - end), np.full((5, 2), rng.uniform(0.03, 0.075)))
            )
    if rng.uniform() < 0.6:
        crown = shoulder + float(rng.uniform(0.02, 0.35))
        parts.append(upright_tube(((0.0, 0.015, 0.015), (crown, 0.02, 0.02))))
        r = float(rng.uniform(0.12, 0.3))
        parts.append(upright_tube(((0.0, r, r), (0.03, r, r))))
        if rng.uniform() < 0.55:
            w = float(rng.uniform(0.08, 0.14))
            parts.append(
                upright_tube(((crown - 0.1, w, w), (crown, w, w), (crown + 0.06, 0.8 * w, 0.8 * w)))
                if rng.uniform() < 0.5
                else upright_tube(((crown - 0.02, 1.7 * w, 1.7 * w), (crown, w, w), (crown + 0.1, 0.8 * w, 0.8 * w)))
            )
    if rng.uniform() < 0.2:
        parts += [box((x - 0.05, 0.0, -0.13), (x + 0.05, float(rng.uniform(0.1, 0.4)), 0.1)) for x in (-0.12, 0.12)]
    return joined(parts)


def bush(rng: Rng) -> Mesh:
    """Leaves on stems, from a house plant to a tomato row."""
    high, count = float(rng.uniform(0.4, 2.1)), int(rng.integers(40, 200))
    spread = rng.uniform(0.06, 0.4), rng.uniform(0.05, 0.2)
    low = float(rng.uniform(0.0, 0.6 * high))
    at = np.stack([rng.normal(0, spread[0], count), rng.uniform(low, high, count), rng.normal(0, spread[1], count)], 1)
    d = rng.normal(0, 1, (count, 3)) + np.array([0.0, rng.uniform(-0.5, 0.8), 0.0])
    d *= rng.uniform(0.05, 0.4, (count, 1)) / np.linalg.norm(d, axis=1, keepdims=True)
    across = np.cross(d, rng.normal(0, 1, (count, 3)))
    across *= rng.uniform(0.008, 0.09) / np.linalg.norm(across, axis=1, keepdims=True)
    leaf = np.stack([at, at + d / 2 + across, at + d, at + d / 2 - across], axis=1).reshape(-1, 3)
    base = 4 * np.arange(count)[:, None]
    faces = np.concatenate([base + np.array([0, 1, 2]), base + np.array([0, 2, 3])]).astype(np.int32)
    parts = [Mesh(leaf, faces), upright_tube(((0.0, 0.01, 0.01), (0.9 * high, 0.01, 0.01)))]
    if rng.uniform() < 0.6:
        r, h = float(rng.uniform(0.08, 0.25)), float(rng.uniform(0.1, 0.5))
        parts.append(upright_tube(((0.0, 0.8 * r, 0.8 * r), (h, r, r))))
    return joined(parts)


def stack(rng: Rng) -> Mesh:
    """Boxes on boxes: a cupboard, a pillar, crates."""
    parts, low = [], 0.0
    for _ in range(int(rng.integers(1, 5))):
        w, d, h = float(rng.uniform(0.08, 0.5)), float(rng.uniform(0.08, 0.4)), float(rng.uniform(0.1, 1.3))
        x, z = rng.uniform(-0.1, 0.1, 2)
        parts.append(_turned(box((x - w, low, z - d), (x + w, low + h, z + d)), _about_y(float(rng.normal(0, 0.3)))))
        low += h
        if low > rng.uniform(0.5, 2.3):
            break
    return joined(parts)


def sack(rng: Rng) -> Mesh:
    """Something round: a sack, a barrel, a vase, a statue without limbs, a rolled mat, a water heater."""
    high, rows = float(rng.uniform(0.5, 1.95)), 10
    down = np.linspace(0, 1, rows)
    wide = float(rng.uniform(0.08, 0.34)) * np.clip(1.0 + np.cumsum(rng.normal(0, 0.16, rows)), 0.3, 1.6)
    lean = np.outer(down, rng.normal(0, 0.08, 2))
    centres = np.stack([lean[:, 0], high * down, lean[:, 1]], axis=1)
    radii = np.stack([wide, wide * float(rng.uniform(0.5, 1.0))], axis=1)
    radii[-1] *= float(rng.uniform(0.3, 1.0))
    return tube(centres, radii)


def bars(rng: Rng) -> Mesh:
    """A ladder, a tripod, a trellis, a rack: thin bars, some of them level."""
    high, half = float(rng.uniform(0.8, 2.1)), float(rng.uniform(0.1, 0.5))
    parts = []
    for _ in range(int(rng.integers(2, 6))):
        foot = np.array([rng.uniform(-half, half), 0.0, rng.uniform(-0.3, 0.3)])
        head = np.array([foot[0] * rng.uniform(0.0, 1.2), high, foot[2] * rng.uniform(0.0, 1.2)])
        parts.append(_bar(foot, head, float(rng.uniform(0.01, 0.04))))
    for y in np.linspace(0.15, 0.95, int(rng.integers(0, 8))) * high:
        r, deep = float(rng.uniform(0.008, 0.03)), float(rng.uniform(0.02, 0.2))
        parts.append(box((-half, y - r, -deep), (half, y + r, deep)))
    return joined(parts)


def wall_piece(rng: Rng) -> Mesh:
    """A partition, a door leaf, a curtain: flat and high."""
    half, high, thick = float(rng.uniform(0.2, 1.0)), float(rng.uniform(0.9, 2.4)), float(rng.uniform(0.01, 0.12))
    if rng.uniform() < 0.5:
        return box((-half, 0.0, -thick), (half, high, thick))
    folds = int(rng.integers(4, 12))
    x = np.linspace(-half, half, 4 * folds)
    z = 0.05 * np.sin(np.linspace(0, 2 * np.pi * folds, 4 * folds)) + rng.normal(0, 0.01, 4 * folds)
    points = np.concatenate([np.stack([x, 0 * x, z], axis=1), np.stack([x, 0 * x + high, z], axis=1)])
    i, n = np.arange(len(x) - 1), len(x)
    faces = np.concatenate([np.stack([i, i + 1, i + n], axis=1), np.stack([i + 1, i + 1 + n, i + n], axis=1)])
    return Mesh(points, faces.astype(np.int32))


THINGS: Final[tuple[Callable[[Rng], Mesh], ...]] = (slab, seat, garment, bush, stack, sack, bars, wall_piece)
LOW: Final[tuple[Callable[[Rng], Mesh], ...]] = (slab, seat, bush, stack)
"""What may stand between the sensor and an operator's legs."""


def random_thing(rng: Rng) -> Mesh:
    """One of THINGS."""
    return THINGS[int(rng.integers(len(THINGS)))](rng)


def low_thing(rng: Rng, most_m: float) -> Mesh:
    """One of LOW, pressed down to at most this height."""
    mesh = LOW[int(rng.integers(len(LOW)))](rng)
    top = float(mesh.vertices_m[:, 1].max())
    squeeze = np.array([1.0, min(1.0, most_m / max(top, 1e-6)), 1.0])
    return Mesh(mesh.vertices_m * squeeze, mesh.faces)
