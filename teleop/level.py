"""Camera axes to floor-levelled axes (specification, section 1)."""

from __future__ import annotations

import math

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
