"""Bounding solids: sphere, vertical or tilted cylinder, box; signed distance and outward normal for many points."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from robot_sim.errors import RobotError
from robot_sim.kinematics.transforms import FloatArray, translation


def _positive(what: str, *sizes: float) -> None:
    if not all(np.isfinite(s) and s > 0 for s in sizes):
        raise RobotError(f"{what}: sizes must be positive, got {sizes}")


@njit(cache=True, nogil=True)
def nearest_points(
    kinds: np.ndarray, T: np.ndarray, sizes: np.ndarray, points: np.ndarray, d: np.ndarray, n: np.ndarray
) -> None:
    """Signed distances d (K, N) and outward normals n (K, N, 3) of points (N, 3) to K solids.

    kinds: 0 sphere (radius), 1 cylinder about z (radius, half height), 2 box (half edges). T (K, 4, 4), sizes (K, 3).
    """
    for k in range(len(kinds)):
        R = T[k]
        for i in range(len(points)):
            x, y, z = points[i, 0] - R[0, 3], points[i, 1] - R[1, 3], points[i, 2] - R[2, 3]
            p0 = R[0, 0] * x + R[1, 0] * y + R[2, 0] * z
            p1 = R[0, 1] * x + R[1, 1] * y + R[2, 1] * z
            p2 = R[0, 2] * x + R[1, 2] * y + R[2, 2] * z
            n0, n1, n2 = 0.0, 0.0, 1.0
            if kinds[k] == 0:
                r = math.sqrt(p0 * p0 + p1 * p1 + p2 * p2)
                if r > 1e-12:
                    n0, n1, n2 = p0 / r, p1 / r, p2 / r
                d[k, i] = r - sizes[k, 0]
            elif kinds[k] == 1:
                rho = math.hypot(p0, p1)
                u0, u1 = (p0 / rho, p1 / rho) if rho > 1e-12 else (1.0, 0.0)
                side, cap = rho - sizes[k, 0], abs(p2) - sizes[k, 1]
                up = 1.0 if p2 >= 0 else -1.0
                if side > 0 and cap > 0:
                    far = math.hypot(side, cap)
                    n0, n1, n2 = u0 * side / far, u1 * side / far, up * cap / far
                    d[k, i] = far
                elif side > cap:
                    n0, n1, n2 = u0, u1, 0.0
                    d[k, i] = side
                else:
                    n0, n1, n2 = 0.0, 0.0, up
                    d[k, i] = cap
            else:
                e0, e1, e2 = abs(p0) - sizes[k, 0], abs(p1) - sizes[k, 1], abs(p2) - sizes[k, 2]
                g0, g1, g2 = math.copysign(1.0, p0), math.copysign(1.0, p1), math.copysign(1.0, p2)
                o0, o1, o2 = max(e0, 0.0), max(e1, 0.0), max(e2, 0.0)
                far = math.sqrt(o0 * o0 + o1 * o1 + o2 * o2)
                if far > 0:
                    n0, n1, n2 = g0 * o0 / far, g1 * o1 / far, g2 * o2 / far
                    d[k, i] = far
                elif e0 >= e1 and e0 >= e2:
                    n0, n1, n2 = g0, 0.0, 0.0
                    d[k, i] = e0
                elif e1 >= e2:
                    n0, n1, n2 = 0.0, g1, 0.0
                    d[k, i] = e1
                else:
                    n0, n1, n2 = 0.0, 0.0, g2
                    d[k, i] = e2
            n[k, i, 0] = R[0, 0] * n0 + R[0, 1] * n1 + R[0, 2] * n2
            n[k, i, 1] = R[1, 0] * n0 + R[1, 1] * n1 + R[1, 2] * n2
            n[k, i, 2] = R[2, 0] * n0 + R[2, 1] * n1 + R[2, 2] * n2


@njit(cache=True, nogil=True)
def _distance(kind: int, T: np.ndarray, size: np.ndarray, x: float, y: float, z: float) -> float:
    """Signed distance of one point to one solid, as ``nearest_points`` has it."""
    x, y, z = x - T[0, 3], y - T[1, 3], z - T[2, 3]
    if kind == 0:
        return math.sqrt(x * x + y * y + z * z) - size[0]
    p0 = T[0, 0] * x + T[1, 0] * y + T[2, 0] * z
    p1 = T[0, 1] * x + T[1, 1] * y + T[2, 1] * z
    p2 = T[0, 2] * x + T[1, 2] * y + T[2, 2] * z
    if kind == 1:
        side, cap = math.hypot(p0, p1) - size[0], abs(p2) - size[1]
        return math.hypot(side, cap) if side > 0 and cap > 0 else max(side, cap)
    e0, e1, e2 = abs(p0) - size[0], abs(p1) - size[1], abs(p2) - size[2]
    o0, o1, o2 = max(e0, 0.0), max(e1, 0.0), max(e2, 0.0)
    outside = math.sqrt(o0 * o0 + o1 * o1 + o2 * o2)
    return outside if outside > 0 else max(e0, max(e1, e2))


@njit(cache=True, nogil=True)
def least_gap(
    kinds: np.ndarray, T: np.ndarray, sizes: np.ndarray, points: np.ndarray, radii: np.ndarray, far: float
) -> float:
    """Smallest signed distance between balls (N, 3), (N,) and K solids, or ``far`` when nothing is nearer."""
    best = far
    for k in range(len(kinds)):
        s = sizes[k]
        if kinds[k] == 0:
            bound = s[0]
        elif kinds[k] == 1:
            bound = math.hypot(s[0], s[1])
        else:
            bound = math.sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2])
        for i in range(len(points)):
            x, y, z = points[i, 0] - T[k, 0, 3], points[i, 1] - T[k, 1, 3], points[i, 2] - T[k, 2, 3]
            # the ball round the solid cannot be nearer than the best so far
            reach = best + radii[i] + bound
            if reach <= 0.0 or x * x + y * y + z * z >= reach * reach:
                continue
            best = min(best, _distance(kinds[k], T[k], s, points[i, 0], points[i, 1], points[i, 2]) - radii[i])
    return best


@dataclass(frozen=True, slots=True, eq=False)
class Solid(ABC):
    """A solid with pose T (4, 4) of its own frame in the world (or in a link), metres."""

    T: FloatArray

    @property
    @abstractmethod
    def packed(self) -> tuple[int, tuple[float, float, float]]:
        """Kind and sizes as ``nearest_points`` takes them."""

    @abstractmethod
    def grown(self, by_m: float) -> Solid:
        """The solid with its surface moved outward by by_m (a box keeps its corners)."""

    def distance(self, points: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Signed distance (N,), negative inside, and outward unit normal (N, 3) for world points (N, 3)."""
        p = np.ascontiguousarray(np.atleast_2d(np.asarray(points, dtype=np.float64)))
        d, n = np.empty((1, len(p))), np.empty((1, len(p), 3))
        kind, sizes = self.packed
        nearest_points(np.array([kind]), self.T[None], np.array([sizes]), p, d, n)
        return d[0], n[0]

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

    @property
    def packed(self) -> tuple[int, tuple[float, float, float]]:
        return 0, (self.radius_m, 0.0, 0.0)

    def grown(self, by_m: float) -> Sphere:
        return Sphere(self.T, self.radius_m + by_m)


@dataclass(frozen=True, slots=True, eq=False)
class Cylinder(Solid):
    """Cylinder about its frame's z, centred."""

    radius_m: float
    height_m: float

    def __post_init__(self) -> None:
        _positive("cylinder", self.radius_m, self.height_m)

    @property
    def packed(self) -> tuple[int, tuple[float, float, float]]:
        return 1, (self.radius_m, self.height_m / 2, 0.0)

    def grown(self, by_m: float) -> Cylinder:
        return Cylinder(self.T, self.radius_m + by_m, self.height_m + 2 * by_m)


@dataclass(frozen=True, slots=True, eq=False)
class Box(Solid):
    """Box centred on its frame; half_m are the half edges along x, y, z."""

    half_m: tuple[float, float, float]

    def __post_init__(self) -> None:
        _positive("box", *self.half_m)

    @property
    def packed(self) -> tuple[int, tuple[float, float, float]]:
        return 2, self.half_m

    def grown(self, by_m: float) -> Box:
        x, y, z = self.half_m
        return Box(self.T, (x + by_m, y + by_m, z + by_m))


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
