"""The tracked skeleton: what perception hands to intent."""

from __future__ import annotations

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
        """Rotation (3, 3) that turns camera axes into floor-levelled axes (tilt and roll removed, yaw kept)."""
        y = self.normal / np.linalg.norm(self.normal)
        z = np.array([0.0, 0.0, 1.0]) - y[2] * y
        z /= np.linalg.norm(z)
        return np.stack([np.cross(y, z), y, z])


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
