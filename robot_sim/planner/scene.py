"""What a path must keep away from: bounding solids, seen by a body of control spheres that moves without turning."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from robot_sim.kinematics.transforms import FloatArray
from robot_sim.planner.shapes import Solid, least_gap, nearest_points


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """Solids in world axes. An empty scene is free everywhere."""

    solids: tuple[Solid, ...]
    _kinds: npt.NDArray[np.int64] = field(init=False, repr=False)
    _T: FloatArray = field(init=False, repr=False)
    _sizes: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        packed = [s.packed for s in self.solids]
        object.__setattr__(self, "_kinds", np.array([k for k, _ in packed], dtype=np.int64))
        object.__setattr__(self, "_T", np.array([s.T for s in self.solids]).reshape(-1, 4, 4))
        object.__setattr__(self, "_sizes", np.array([s for _, s in packed], dtype=np.float64).reshape(-1, 3))

    def nearest(self, points_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Signed distance (K, N) and outward normal (K, N, 3) of points (N, 3) to each of the K solids."""
        k, n = len(self.solids), len(points_m)
        d, normals = np.empty((k, n)), np.empty((k, n, 3))
        nearest_points(self._kinds, self._T, self._sizes, np.ascontiguousarray(points_m), d, normals)
        return d, normals

    def gap(self, points_m: FloatArray, radii_m: FloatArray, far_m: float = np.inf) -> float:
        """Smallest distance between balls (N, 3), radii (N,), and the solids; negative where they overlap.

        far_m: nothing further away than this matters, which is much quicker.
        """
        points, radii = np.ascontiguousarray(points_m), np.ascontiguousarray(radii_m, np.float64)
        return float(least_gap(self._kinds, self._T, self._sizes, points, radii, far_m))

    def clearance(self, positions_m: FloatArray, offsets_m: FloatArray, radii_m: FloatArray) -> FloatArray:
        """Least distance (M,) between the solids and the body at positions (M, 3).

        The body is spheres at offsets (C, 3) with radii (C,) around its position.
        """
        if not self.solids:
            return np.full(len(positions_m), np.inf)
        points = (positions_m[:, None, :] + offsets_m[None]).reshape(-1, 3)
        d = self.nearest(points)[0].min(axis=0)
        return np.asarray((d.reshape(len(positions_m), -1) - radii_m).min(axis=1))
