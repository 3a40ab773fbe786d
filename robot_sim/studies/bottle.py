"""A culture bottle as a surface of revolution, and how near the arm's solids come to its wall."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from robot_sim.kinematics.transforms import FloatArray
from robot_sim.planner.shapes import Cylinder
from robot_sim.studies.config import BottleConfig


@dataclass(frozen=True, slots=True, eq=False)
class Bottle:
    """Inner wall of a bottle standing at mouth_m (3,), the centre of its mouth."""

    mouth_m: FloatArray
    config: BottleConfig

    @property
    def profile(self) -> FloatArray:
        """Polyline (K, 2) of (radius, height under the mouth) from the rim down to the middle of the bottom."""
        c = self.config
        shoulder = c.neck_height_m + abs(c.body_radius_m - c.neck_radius_m)
        rim = (c.neck_radius_m, 0.0)
        return np.array(
            [
                rim,
                (c.neck_radius_m, c.neck_height_m),
                (c.body_radius_m, shoulder),
                (c.body_radius_m, c.height_m),
                (0, c.height_m),
            ]
        )

    def clearance(self, points_m: FloatArray) -> FloatArray:
        """Distance (N,) of world points (N, 3) to the glass, from inside or outside; negative in the glass."""
        p = points_m - self.mouth_m
        rz = np.stack([np.hypot(p[:, 0], p[:, 1]), -p[:, 2]], axis=1)
        profile = self.profile
        best = np.full(len(rz), np.inf)
        for a, b in pairwise(profile):
            along = b - a
            share = np.clip((rz - a) @ along / max(float(along @ along), 1e-18), 0, 1)
            best = np.minimum(best, np.linalg.norm(rz - a - share[:, None] * along, axis=1))
        radius = np.interp(rz[:, 1], profile[:-1, 1], profile[:-1, 0])
        outside = (rz[:, 1] > 0) & ((rz[:, 0] > radius) | (rz[:, 1] > profile[-1, 1]))
        return np.where(outside, best - self.config.glass_m, best)


def surface_points(solid: Cylinder, rings: int = 9, spokes: int = 24) -> FloatArray:
    """Points (N, 3) on a cylinder's side and rims, in the frame its pose is given in."""
    angle = np.linspace(0, 2 * np.pi, spokes, endpoint=False)
    height = np.linspace(-solid.height_m / 2, solid.height_m / 2, rings)
    a, h = (g.ravel() for g in np.meshgrid(angle, height))
    local = np.stack([solid.radius_m * np.cos(a), solid.radius_m * np.sin(a), h], axis=1)
    return local @ solid.T[:3, :3].T + solid.T[:3, 3]


def swept_clearance(
    bottles: Sequence[Bottle], frames: FloatArray, bodies: Sequence[tuple[int, FloatArray]]
) -> FloatArray:
    """Least clearance (M,) at each of M samples: frames (M, K, 4, 4), bodies as (frame index, points (N, 3))."""
    out = np.full(len(frames), np.inf)
    for k, T in enumerate(frames):
        points = np.concatenate([p @ T[i][:3, :3].T + T[i][:3, 3] for i, p in bodies])
        out[k] = min(float(b.clearance(points).min()) for b in bottles)
    return out
