"""Poses that do not repeat: a greedy choice in which any two differ by a least distance (Shotton 2011, section 2.1)."""

from __future__ import annotations

from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

_LENGTHS_M: Final = np.array([0.30, 0.33, 0.42, 0.42])
"""Upper arm, forearm, thigh and shin of a mean person: directions become places."""


def limb_ends(limbs: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Elbows, wrists, knees and ankles (N, 8, 3) in metres from shoulder or hip, for directions (N, 2, 5, 3)."""
    bones = limbs[:, :, :4] * _LENGTHS_M[:, None]
    upper, lower = bones[:, :, 0::2], bones[:, :, 1::2]
    return np.concatenate([upper, upper + lower], axis=2).reshape(len(limbs), 8, 3)


@nb.njit(cache=True, nogil=True)
def distinct(points_m: npt.NDArray[np.float64], least_m: float) -> npt.NDArray[np.int64]:
    """Indices, ascending, of a maximal choice of poses (N, P, 3): any two have one point ``least_m`` or more apart."""
    n, parts = points_m.shape[0], points_m.shape[1]
    kept = np.empty(n, np.int64)
    count = 0
    for i in range(n):
        new = True
        # neighbours in time are likeliest alike, so the latest are compared first
        for k in range(count - 1, -1, -1):
            far = False
            for p in range(parts):
                d = points_m[i, p] - points_m[kept[k], p]
                if d[0] * d[0] + d[1] * d[1] + d[2] * d[2] >= least_m * least_m:
                    far = True
                    break
            if not far:
                new = False
                break
        if new:
            kept[count] = i
            count += 1
    return kept[:count].copy()
