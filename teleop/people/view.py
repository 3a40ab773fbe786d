"""Where the sensor stands, and which joints it sees."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from teleop.frames import Camera, pixels
from teleop.people.body import Bytes, Floats32
from teleop.people.pose import rotation
from teleop.people.rig import Floats

SEEN_RADIUS_M = 0.08
SEEN_BEFORE_M = 0.25


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """A sensor over the room's origin. R (3, 3), t_m (3,): camera = R room + t. Room: levelled axes, floor y = 0."""

    R: Floats
    t_m: Floats
    height_m: float


def sensor_view(height_m: float, tilt_rad: float, roll_rad: float = 0.0) -> View:
    """A sensor at a height above the floor; positive tilt looks up."""
    R = rotation(np.array([0.0, 0.0, 1.0]), roll_rad) @ rotation(np.array([1.0, 0.0, 0.0]), tilt_rad)
    return View(R, R @ np.array([0.0, -height_m, 0.0]), height_m)


def visible_joints(joints: Floats, depth_m: Floats32, part: Bytes, camera: Camera) -> npt.NDArray[np.bool_]:
    """Which joints (20, 3) are seen, (20,) bool.

    A joint is seen when some pixel of its part lies within 8 cm of it across the line of sight and no more than
    25 cm in front of it: its neighbourhood is in the image and nothing hides it.
    """
    out = np.zeros(len(joints), np.bool_)
    h, w = part.shape
    for j, z in enumerate(joints[:, 2]):
        if z < 0.3:
            continue
        u, v = pixels(joints[j], camera)
        r = SEEN_RADIUS_M * camera.depth.fx / z
        u0, u1, v0, v1 = int(max(0, u - r)), int(min(w, u + r + 1)), int(max(0, v - r)), int(min(h, v + r + 1))
        if u0 >= u1 or v0 >= v1:
            continue
        seen = depth_m[v0:v1, u0:u1]
        near = (seen > z - SEEN_BEFORE_M) & (seen < z + SEEN_RADIUS_M)
        out[j] = bool((near & (part[v0:v1, u0:u1] == j)).any())
    return out
