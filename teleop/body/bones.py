"""Constant bones: an operator's bone lengths are learned from sure frames, and joints are moved to agree with them.

Each joint gives way by the variance it was found with (Müller et al. 2007, position based dynamics, with the bones'
own variance as compliance). Left and right bones are one length.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.config.body import BonesConfig
from teleop.joints import JOINT_INDEX

Floats = npt.NDArray[np.float64]
KINDS: Final = ("shoulder elbow", "elbow wrist", "hip knee", "knee ankle")
PAIRS: Final = np.array(
    [[[JOINT_INDEX[f"{end}_{side}"] for end in kind.split()] for side in ("right", "left")] for kind in KINDS]
)
"""Joints (KINDS, sides, 2) of the bones whose length is learned."""


@dataclass(frozen=True, slots=True, eq=False)
class Bones:
    """What is known of an operator's bones. length_m: (KINDS,), NaN unknown. weight: (KINDS,) frames seen, as surely as
    the surest."""

    length_m: Floats
    weight: Floats


def unknown_bones() -> Bones:
    """Nobody's."""
    return Bones(np.full(len(KINDS), np.nan), np.zeros(len(KINDS)))


def learn(bones: Bones, joints_m: Floats, spread_m: Floats, config: BonesConfig) -> Bones:
    """The lengths after one more frame: running means weighted by how surely both ends were found.

    joints_m: (20, 3), NaN unknown. spread_m: (20,).
    """
    ends, spread = joints_m[PAIRS], spread_m[PAIRS]
    found = np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=2)
    with np.errstate(invalid="ignore"):
        sure = config.learn_spread_m**2 / np.maximum((spread**2).sum(axis=2), 1e-8)
    share = np.where(np.isnan(found) | (sure < 0.25), 0.0, np.minimum(sure, 1.0))
    total = share.sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.nansum(np.where(share > 0, share * found, 0.0), axis=1) / total
    kept = np.minimum(bones.weight, config.memory_frames - total)
    length = np.where(
        total > 0, np.where(np.isnan(bones.length_m), mean, (kept * bones.length_m + total * mean) / (kept + total)),
        bones.length_m,
    )  # fmt: skip
    return Bones(length, np.where(total > 0, kept + total, bones.weight))


@nb.njit(cache=True, nogil=True)
def _relax(
    joints_m: Floats, variance: Floats, pairs: npt.NDArray[np.int64], length_m: Floats, own: Floats, sweeps: int
) -> None:
    for _ in range(sweeps):
        for kind in range(len(pairs)):
            if np.isnan(length_m[kind]):
                continue
            for side in range(pairs.shape[1]):
                a, b = pairs[kind, side]
                total = 0.0
                for k in range(3):
                    total += (joints_m[b, k] - joints_m[a, k]) ** 2
                long = np.sqrt(total)
                if np.isnan(long) or long < 1e-3:
                    continue
                share = (long - length_m[kind]) / (variance[a] + variance[b] + own[kind]) / long
                for k in range(3):
                    d = joints_m[b, k] - joints_m[a, k]
                    joints_m[a, k] += share * variance[a] * d
                    joints_m[b, k] -= share * variance[b] * d


def straighten(joints_m: Floats, spread_m: Floats, bones: Bones, config: BonesConfig) -> Floats:
    """The joints (20, 3), moved to agree with the bones as far as both are known."""
    out = joints_m.copy()
    known = bones.weight >= config.least_frames
    length = np.where(known, bones.length_m, np.nan)
    own = config.tolerance_m**2 * (1.0 + config.least_frames / np.maximum(bones.weight, 1.0))
    _relax(out, spread_m**2, PAIRS, length, own, config.sweeps)
    return out
