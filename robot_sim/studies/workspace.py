"""The tomato arm's workspace by sampling joints, and voids counted by voxel occupancy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit
from scipy import ndimage

from robot_sim.kinematics.chain import Chain
from robot_sim.kinematics.kernels import forward_one
from robot_sim.kinematics.transforms import FloatArray


def joint_grid(lower_deg: float, upper_deg: float, step_deg: float) -> FloatArray:
    """lower, lower + step, ... up to upper, in rad; the source's stepping, which need not reach the upper end."""
    return np.radians(np.arange(lower_deg, upper_deg + 1e-9, step_deg))


def all_combinations(grids: list[FloatArray]) -> FloatArray:
    """Every combination of the joints' values (N, n), the last joint running fastest."""
    return np.stack([g.ravel() for g in np.meshgrid(*grids, indexing="ij")], axis=1)


@njit(cache=True, nogil=True)
def _fill(
    fixed: np.ndarray,
    slides: np.ndarray,
    g1: np.ndarray,
    g3: np.ndarray,
    g4: np.ndarray,
    g5: np.ndarray,
    origin: np.ndarray,
    voxel: float,
    hit: np.ndarray,
) -> int:
    """Mark the voxels that the tool's origin meets over theta12 x theta3 x theta4 x theta5; returns the samples."""
    q = np.zeros(5)
    T = np.empty((4, 4))
    count = 0
    for a in g1:
        q[0] = a
        for b in g3:
            q[2] = b
            for c in g4:
                q[3] = c
                for d in g5:
                    q[4] = d
                    forward_one(fixed, slides, q, T)
                    i = int((T[0, 3] - origin[0]) / voxel)
                    j = int((T[1, 3] - origin[1]) / voxel)
                    k = int((T[2, 3] - origin[2]) / voxel)
                    hit[i, j, k] = True
                    count += 1
    return count


@dataclass(frozen=True, slots=True, eq=False)
class Voids:
    """Voxel occupancy: voxel edge, samples, occupied voxels, empty ones cut off from the outside, their pockets."""

    voxel_m: float
    samples: int
    occupied: int
    enclosed: int
    pockets: int

    @property
    def enclosed_m3(self) -> float:
        """Volume of all enclosed voids in m^3."""
        return self.enclosed * self.voxel_m**3


def count_voids(hit: npt.NDArray[np.bool_], voxel_m: float, samples: int) -> Voids:
    """Voids of an occupancy grid: empty voxels not joined to the outside through faces."""
    empty = np.pad(~hit, 1, constant_values=True)
    labels, _ = ndimage.label(empty)
    inside = empty & (labels != labels[0, 0, 0])
    pockets = len(np.unique(labels[inside]))
    return Voids(voxel_m, samples, int(hit.sum()), int(inside.sum()), pockets)


def occupancy(points_m: FloatArray, voxel_m: float) -> npt.NDArray[np.bool_]:
    """Voxels (i, j, k) that hold at least one of the points (N, 3)."""
    index = ((points_m - points_m.min(axis=0)) / voxel_m).astype(np.int64)
    hit = np.zeros(tuple(index.max(axis=0) + 1), dtype=np.bool_)
    hit[tuple(index.T)] = True
    return hit


def fine_occupancy(
    chain: Chain, limits_deg: tuple[float, ...], step_deg: float, voxel_m: float
) -> tuple[npt.NDArray[np.bool_], FloatArray, int]:
    """Occupancy of a fine grid: (voxels, their origin in m, samples).

    theta1 and theta2 count only by their sum, which covers the circle; so theta12 runs once round and not through
    both joints.
    """
    circle = np.radians(np.arange(-180.0, 180.0, step_deg))
    g3, g4, g5 = (np.radians(np.linspace(-lim, lim, round(2 * lim / step_deg) + 1)) for lim in limits_deg[2:])
    reach = sum(float(np.linalg.norm(F[:3, 3])) for F in chain.fixed[3:])
    middle = np.array([0.0, 0.0, chain.fixed[1][2, 3]])
    origin = middle - reach - voxel_m
    size = int(np.ceil((2 * reach + 2 * voxel_m) / voxel_m)) + 1
    hit = np.zeros((size, size, size), dtype=np.bool_)
    samples = int(_fill(chain.fixed, chain.is_prismatic, circle, g3, g4, g5, origin, voxel_m, hit))
    return hit, origin, samples
