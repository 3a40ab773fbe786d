"""Camera axes to floor-levelled axes (specification, section 1)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from teleop.config.intent import LevelConfig
from teleop.skeleton import FloorPlane, Skeleton

Vector = npt.NDArray[np.float64]


def rotation_level_camera(floor: FloorPlane | None, config: LevelConfig) -> Vector:
    """Rotation (3, 3) from camera axes to the axes zones and angles use.

    The floor decides when it is seen, the calibrated tilt otherwise; ``level: off`` is the identity.
    """
    if config.level == "off":
        return np.eye(3)
    if floor is not None:
        return floor.R_level_camera()
    c, s = math.cos(math.radians(config.tilt_deg)), math.sin(math.radians(config.tilt_deg))
    return np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])


def levelled(skeleton: Skeleton, R_level_camera: Vector) -> Skeleton:
    """The same skeleton in levelled axes; only for intent, the tracked one is never levelled."""
    return Skeleton(skeleton.t_ns, skeleton.joints_m @ R_level_camera.T, skeleton.confidence)


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """The floor that is believed. other: the one seen instead, other_s: for how long now."""

    floor: FloorPlane | None = None
    other: FloorPlane | None = None
    other_s: float = 0.0

    @property
    def doubted(self) -> bool:
        """Whether the last frame showed another floor than the one that is believed."""
        return self.other is not None


def step_ground(ground: Ground, seen: FloorPlane | None, dt_s: float, config: LevelConfig) -> Ground:
    """One frame. A sensor stands still: a floor that tilts at once is a table, a wall, or a sensor that was knocked.

    The first floor is believed at once, another one only after it has stayed the same for ``settle_s``; an unseen one
    changes nothing.
    """
    if seen is None:
        return ground
    if ground.floor is None or _alike(ground.floor, seen, config):
        return Ground(seen)
    other_s = ground.other_s + dt_s if ground.other is not None and _alike(ground.other, seen, config) else 0.0
    return Ground(seen) if other_s >= config.settle_s else Ground(ground.floor, seen, other_s)


def _alike(a: FloorPlane, b: FloorPlane, config: LevelConfig) -> bool:
    cosine = float(a.normal @ b.normal) / float(np.linalg.norm(a.normal) * np.linalg.norm(b.normal))
    return cosine >= math.cos(math.radians(config.jump_deg))
