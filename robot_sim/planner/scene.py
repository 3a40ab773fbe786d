"""What a path must keep away from: bounding solids, seen by a body of control spheres that moves without turning."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robot_sim.kinematics.transforms import FloatArray
from robot_sim.planner.shapes import Solid


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """Solids in world axes. An empty scene is free everywhere."""

    solids: tuple[Solid, ...]

    def nearest(self, points_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Signed distance (K, N) and outward normal (K, N, 3) of points (N, 3) to each of the K solids."""
        if not self.solids:
            return np.empty((0, len(points_m))), np.empty((0, len(points_m), 3))
        found = [s.distance(points_m) for s in self.solids]
        return np.stack([d for d, _ in found]), np.stack([n for _, n in found])

    def clearance(self, positions_m: FloatArray, offsets_m: FloatArray, radii_m: FloatArray) -> FloatArray:
        """Least distance (M,) between the solids and the body at positions (M, 3).

        The body is spheres at offsets (C, 3) with radii (C,) around its position.
        """
        if not self.solids:
            return np.full(len(positions_m), np.inf)
        points = (positions_m[:, None, :] + offsets_m[None]).reshape(-1, 3)
        d = np.min([s.distance(points)[0] for s in self.solids], axis=0)
        return np.asarray((d.reshape(len(positions_m), -1) - radii_m).min(axis=1))
