"""The tracked skeleton: what perception hands to intent."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from teleop.joints import JOINT_INDEX


@dataclass(frozen=True, slots=True, eq=False)
class Skeleton:
    """20 joints of the one tracked operator in the camera's own axes (never levelled).

    joints_m: (20, 3) float64, row NaN = unknown. confidence: (20,) float64 in 0..1.
    """

    t_ns: int
    joints_m: npt.NDArray[np.float64]
    confidence: npt.NDArray[np.float64]

    def joint(self, name: str) -> npt.NDArray[np.float64] | None:
        """Position (3,) of a joint in metres, or None when it is unknown."""
        p = self.joints_m[JOINT_INDEX[name]]
        return None if np.isnan(p).any() else p


@dataclass(frozen=True, slots=True, eq=False)
class FloorPlane:
    """The floor in camera axes: unit normal (3,) pointing up, and the camera's height above it in metres."""

    normal: npt.NDArray[np.float64]
    camera_height_m: float

    def R_level_camera(self) -> npt.NDArray[np.float64]:
        """Rotation (3, 3) that turns camera axes into floor-levelled axes (tilt and roll removed, yaw kept).

        Raises ValueError for a sensor that looks straight down or up: it has no yaw that could be kept.
        """
        # in plain numbers: called for every frame, and a cross product alone takes numpy 15 microseconds
        a, b, c = self.normal.tolist()
        length = math.sqrt(a * a + b * b + c * c)
        a, b, c = a / length, b / length, c / length
        level = math.sqrt(a * a + b * b)  # of (0, 0, 1) less its part along y: (-a c, -b c, a^2 + b^2) is so long
        if level == 0.0:
            raise ValueError("the sensor looks straight down or up; tilt it until it sees the operator from the front")
        z = (-a * c / level, -b * c / level, level)
        x = (b * z[2] - c * z[1], c * z[0] - a * z[2], a * z[1] - b * z[0])
        return np.array([x, (a, b, c), z])


@dataclass(frozen=True, slots=True, eq=False)
class BodyParts:
    """The forest's answer for the operator's pixels.

    u, v: (N,) int32 pixel columns and rows. points_m: (N, 3) float32 skeleton space.
    probability: (N, P) float32, rows sum to 1, P the model's parts. stride: pixel step used.
    """

    u: npt.NDArray[np.int32]
    v: npt.NDArray[np.int32]
    points_m: npt.NDArray[np.float32]
    probability: npt.NDArray[np.float32]
    stride: int


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """Perception of one frame. skeleton is None when nobody is there.

    mask: (H, W) bool, the operator's pixels, or None. box: (u0, v0, u1, v1) around them, or None.
    reset: the tracker started anew at this frame (gap in time, cut in the scene, new operator).
    """

    t_ns: int
    skeleton: Skeleton | None
    parts: BodyParts | None
    floor: FloorPlane | None
    mask: npt.NDArray[np.bool_] | None
    box: tuple[int, int, int, int] | None
    reset: bool = False
