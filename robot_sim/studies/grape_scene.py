"""Bunches of grapes on a cane: true berries, the bounding cylinder the planner sees, the camera's error."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from robot_sim.kinematics.transforms import FloatArray, rot_z, translation
from robot_sim.planner.shapes import Box, Cylinder, Solid, upright_cylinder
from robot_sim.studies.config import GrapeStudyConfig


@dataclass(frozen=True, slots=True, eq=False)
class Bunch:
    """One bunch in world axes: berries (N, 3) and radii (N,), in m; the peduncle rises from top_m (3,) to the cane."""

    berries_m: FloatArray
    radii_m: FloatArray
    top_m: FloatArray
    peduncle_m: float

    @property
    def volume(self) -> Cylinder:
        """Smallest upright cylinder about the peduncle's line with all berries in it (the source's volume)."""
        away = np.hypot(*(self.berries_m[:, :2] - self.top_m[:2]).T) + self.radii_m
        low = float((self.berries_m[:, 2] - self.radii_m).min())
        high = float((self.berries_m[:, 2] + self.radii_m).max())
        return upright_cylinder((self.top_m[0], self.top_m[1], (low + high) / 2), float(away.max()), high - low)

    def stem(self, radius_m: float) -> Cylinder:
        """The bare peduncle from the bunch to the cane."""
        return upright_cylinder(self.top_m + np.array([0.0, 0.0, self.peduncle_m / 2]), radius_m, self.peduncle_m)

    def moved(self, by_m: FloatArray) -> Bunch:
        """The bunch shifted by (3,) m."""
        return replace(self, berries_m=self.berries_m + by_m, top_m=self.top_m + by_m)


@dataclass(frozen=True, slots=True, eq=False)
class GrapeScene:
    """One or two bunches under a cane, perhaps a post. bunches[0] is nothing special: the planner chooses."""

    bunches: tuple[Bunch, ...]
    cane: Solid
    post: Solid | None

    @property
    def obstacles(self) -> tuple[Solid, ...]:
        """Everything but the bunches."""
        return (self.cane,) if self.post is None else (self.cane, self.post)


def make_bunch(c: GrapeStudyConfig, top_m: FloatArray, peduncle_m: float, rng: np.random.Generator) -> Bunch:
    """Layers of berries inside a tapered outline: shoulders at a quarter of the height, half as wide at the tip."""
    height, radius = rng.uniform(*c.height_m), rng.uniform(*c.diameter_m) / 2
    berry = rng.uniform(*c.berry_m)
    centres = []
    z = berry
    layer = 0
    while z < height - berry * 0.5:
        u = z / height
        outline = radius * (np.interp(u, [0.0, 0.25, 1.0], [0.55, 1.0, 0.45]))
        rim = outline - berry
        # berries inside the bunch touch nothing; only the uppermost layers show theirs from above
        rings = [rim] if layer > 1 else [rim, rim - 1.9 * berry, rim - 3.8 * berry]
        for r in rings:
            if r < 0.6 * berry:
                continue
            count = max(3, int(2 * np.pi * r / (1.95 * berry)))
            a = 2 * np.pi * (np.arange(count) + 0.5 * (layer % 2)) / count + rng.normal(0, 0.05, count)
            jitter = rng.normal(0, 0.08 * berry, (count, 3))
            ring = np.stack([r * np.cos(a), r * np.sin(a), np.full(count, -z)], axis=1) + jitter
            centres.append(ring)
        z += 1.6 * berry
        layer += 1
    berries = np.concatenate(centres)
    radii = berry * rng.uniform(0.9, 1.05, len(berries))
    berries[:, 2] -= float((berries[:, 2] + radii).max())  # the highest berry ends at the top
    return Bunch(berries + top_m, radii, np.asarray(top_m, dtype=np.float64), peduncle_m)


def make_scene(c: GrapeStudyConfig, overlapping: bool, rng: np.random.Generator) -> GrapeScene:
    """A random scene: a single bunch, or a pair that hangs touching from one cane."""
    azimuth = np.radians(rng.uniform(-c.azimuth_deg, c.azimuth_deg))
    distance = rng.uniform(*c.distance_m)
    top = np.array([distance * np.cos(azimuth), distance * np.sin(azimuth), rng.uniform(*c.top_m)])
    peduncle = rng.uniform(*c.peduncle_m)
    bunches = [make_bunch(c, top, peduncle, rng)]
    cane_z = top[2] + peduncle + c.cane_radius_m
    along = azimuth + np.pi / 2
    if overlapping:
        along = rng.uniform(0, np.pi)
        other = rng.uniform(*c.peduncle_m)
        second = make_bunch(c, np.zeros(3), other, rng)
        gap = rng.uniform(*c.pair_gap) * (bunches[0].volume.radius_m + second.volume.radius_m)
        shift = np.array([gap * np.cos(along), gap * np.sin(along), 0.0])
        # the pair lies about the drawn place, neither bunch further out than the other on average
        bunches = [bunches[0].moved(-shift / 2), second.moved(top + shift / 2 + (0, 0, peduncle - other))]
    x, y = top[:2]
    cane_pose = translation(x, y, cane_z) @ rot_z(along)
    cane = Box(cane_pose, (0.25, c.cane_radius_m, c.cane_radius_m))
    post = None
    if rng.random() < c.post_share:
        side = rng.choice([-1.0, 1.0]) * np.radians(rng.uniform(28, 50))
        far = distance * rng.uniform(0.95, 1.15)
        post = upright_cylinder((far * np.cos(azimuth + side), far * np.sin(azimuth + side), 0.1), 0.02, 1.0)
    return GrapeScene(tuple(bunches), cane, post)


def camera_error(c: GrapeStudyConfig, pair: bool, at_m: FloatArray, looks: int, rng: np.random.Generator) -> FloatArray:
    """Mean error (3,) in m, world axes, of some looks at a point (3,): across the line of sight, along it, vertical."""
    mean_mm = c.pair_error_mm if pair else c.single_error_mm
    sigma = np.array(mean_mm) * 1e-3 * np.sqrt(np.pi / 2)  # of a normal whose mean absolute value is given
    across, depth, up = (sigma * rng.standard_normal((looks, 3))).mean(axis=0)
    bearing = np.arctan2(at_m[1], at_m[0])
    cos, sin = np.cos(bearing), np.sin(bearing)
    return np.array([depth * cos - across * sin, depth * sin + across * cos, up])


def seen_scene(
    scene: GrapeScene, c: GrapeStudyConfig, looks: int, rng: np.random.Generator
) -> tuple[GrapeScene, tuple[FloatArray, ...]]:
    """What the camera makes of it: every bunch shifted by its own mean error of the looks; also the errors (3,).

    looks 0 sees exactly. Errors are normal with the source's mean absolute values: across the line of sight, along
    it, vertical. The cane is seen together with the bunches and shifted by their mean error.
    """
    if looks == 0:
        return scene, tuple(np.zeros(3) for _ in scene.bunches)
    pair = len(scene.bunches) > 1
    errors = [camera_error(c, pair, b.top_m, looks, rng) for b in scene.bunches]
    bunches = tuple(b.moved(e) for b, e in zip(scene.bunches, errors, strict=True))
    shift = np.mean(errors, axis=0)
    cane = Box(translation(*shift) @ scene.cane.T, scene.cane.half_m) if isinstance(scene.cane, Box) else scene.cane
    return GrapeScene(bunches, cane, scene.post), tuple(errors)
