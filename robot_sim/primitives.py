"""Things to draw or to run into: boxes, cylinders and spheres with their pose and colour."""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, atan2, cos, hypot, sin
from typing import Literal

import numpy as np
import numpy.typing as npt

Rgba = tuple[float, float, float, float]
Vec3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Primitive:
    """One thing to draw. size_m: box (x, y, z), cylinder (radius, length; along its z), sphere (radius,).

    solid: whether the robot can run into it. rpy_rad: roll, pitch, yaw about fixed axes.
    """

    name: str
    kind: Literal["box", "cylinder", "sphere"]
    size_m: tuple[float, ...]
    xyz_m: Vec3
    rpy_rad: Vec3
    rgba: Rgba
    solid: bool = False


def rotation(rpy_rad: Vec3) -> npt.NDArray[np.float64]:
    """(3, 3) rotation of roll, pitch, yaw about fixed axes: Rz Ry Rx, as in URDF."""
    (sr, cr), (sp, cp), (sy, cy) = ((sin(a), cos(a)) for a in rpy_rad)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_of(R: npt.NDArray[np.float64]) -> Vec3:
    """Roll, pitch, yaw [rad] of a rotation whose pitch is not 90 degrees; the inverse of :func:`rotation`."""
    pitch = asin(min(1.0, max(-1.0, -R[2, 0])))
    return (atan2(R[2, 1], R[2, 2]), pitch, atan2(R[1, 0], R[0, 0]))


def rod(name: str, a: Vec3, b: Vec3, radius: float, rgba: Rgba) -> Primitive:
    """A cylinder from one point to another [m]."""
    dx, dy, dz = (float(q - p) for p, q in zip(a, b, strict=True))
    flat = hypot(dx, dy)
    middle = tuple(float(0.5 * (p + q)) for p, q in zip(a, b, strict=True))
    rpy = (0.0, atan2(flat, dz), atan2(dy, dx) if flat > 0.0 else 0.0)
    return Primitive(name, "cylinder", (radius, hypot(flat, dz)), (middle[0], middle[1], middle[2]), rpy, rgba)
