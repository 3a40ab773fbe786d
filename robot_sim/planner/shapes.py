"""Bounding solids: sphere, vertical or tilted cylinder, box; signed distance and outward normal for many points."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robot_sim.errors import RobotError
from robot_sim.kinematics.transforms import FloatArray, translation


def _positive(what: str, *sizes: float) -> None:
    if not all(np.isfinite(s) and s > 0 for s in sizes):
        raise RobotError(f"{what}: sizes must be positive, got {sizes}")


@dataclass(frozen=True, slots=True, eq=False)
class Solid(ABC):
    """A solid with pose T (4, 4) of its own frame in the world (or in a link), metres."""

    T: FloatArray

    @abstractmethod
    def _local(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Signed distance (N,) and outward unit normal (N, 3) for points (N, 3) in the solid's frame."""

    @abstractmethod
    def grown(self, by_m: float) -> Solid:
        """The solid with its surface moved outward by by_m (a box keeps its corners)."""

    def distance(self, points: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Signed distance (N,), negative inside, and outward unit normal (N, 3) for world points (N, 3)."""
        p = np.atleast_2d(np.asarray(points, dtype=np.float64))
        R = self.T[:3, :3]
        d, n = self._local((p - self.T[:3, 3]) @ R)
        return d, n @ R.T

    @property
    def centre(self) -> FloatArray:
        """Centre (3,)."""
        return self.T[:3, 3]


@dataclass(frozen=True, slots=True, eq=False)
class Sphere(Solid):
    """Ball around its frame's origin."""

    radius_m: float

    def __post_init__(self) -> None:
        _positive("sphere", self.radius_m)

    def _local(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        r = np.linalg.norm(p, axis=1)
        n = np.where(r[:, None] > 1e-12, p / np.maximum(r, 1e-12)[:, None], np.array([0.0, 0.0, 1.0]))
        return r - self.radius_m, n

    def grown(self, by_m: float) -> Sphere:
        return Sphere(self.T, self.radius_m + by_m)


@dataclass(frozen=True, slots=True, eq=False)
class Cylinder(Solid):
    """Cylinder about its frame's z, centred."""

    radius_m: float
    height_m: float

    def __post_init__(self) -> None:
        _positive("cylinder", self.radius_m, self.height_m)

    def _local(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        rho = np.hypot(p[:, 0], p[:, 1])
        radial = np.zeros_like(p)
        safe = np.maximum(rho, 1e-12)
        radial[:, 0] = np.where(rho > 1e-12, p[:, 0] / safe, 1.0)
        radial[:, 1] = np.where(rho > 1e-12, p[:, 1] / safe, 0.0)
        axial = np.zeros_like(p)
        axial[:, 2] = np.where(p[:, 2] >= 0, 1.0, -1.0)
        over = np.stack([rho - self.radius_m, np.abs(p[:, 2]) - self.height_m / 2], axis=1)
        return _from_excess(over, np.stack([radial, axial], axis=1))

    def grown(self, by_m: float) -> Cylinder:
        return Cylinder(self.T, self.radius_m + by_m, self.height_m + 2 * by_m)


@dataclass(frozen=True, slots=True, eq=False)
class Box(Solid):
    """Box centred on its frame; half_m are the half edges along x, y, z."""

    half_m: tuple[float, float, float]

    def __post_init__(self) -> None:
        _positive("box", *self.half_m)

    def _local(self, p: FloatArray) -> tuple[FloatArray, FloatArray]:
        axes = np.zeros((len(p), 3, 3))
        for k in range(3):
            axes[:, k, k] = np.where(p[:, k] >= 0, 1.0, -1.0)
        return _from_excess(np.abs(p) - np.array(self.half_m), axes)

    def grown(self, by_m: float) -> Box:
        x, y, z = self.half_m
        return Box(self.T, (x + by_m, y + by_m, z + by_m))


def _from_excess(over: FloatArray, directions: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Distance and normal from the excess (N, k) over each face and the faces' directions (N, k, 3)."""
    outside = np.maximum(over, 0.0)
    far = np.linalg.norm(outside, axis=1)
    inner = over.max(axis=1)
    is_out = far > 0
    face = np.take_along_axis(directions, over.argmax(axis=1)[:, None, None], axis=1)[:, 0]
    blend = np.einsum("nk,nkc->nc", outside, directions) / np.maximum(far, 1e-300)[:, None]
    return np.where(is_out, far, inner), np.where(is_out[:, None], blend, face)


def sphere(centre_m: npt.ArrayLike, radius_m: float) -> Sphere:
    """Sphere from centre (3,) and radius."""
    x, y, z = np.asarray(centre_m, dtype=np.float64)
    return Sphere(translation(x, y, z), radius_m)


def upright_cylinder(centre_m: npt.ArrayLike, radius_m: float, height_m: float) -> Cylinder:
    """Vertical cylinder from its centre (3,)."""
    x, y, z = np.asarray(centre_m, dtype=np.float64)
    return Cylinder(translation(x, y, z), radius_m, height_m)


def box(centre_m: npt.ArrayLike, size_m: npt.ArrayLike) -> Box:
    """Axis-aligned box from its centre (3,) and full edges (3,)."""
    x, y, z = np.asarray(centre_m, dtype=np.float64)
    a, b, c = np.asarray(size_m, dtype=np.float64) / 2
    return Box(translation(x, y, z), (float(a), float(b), float(c)))
