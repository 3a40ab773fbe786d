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


@nb.njit(cache=True, nogil=True)
def _learn(
    length_m: Floats,
    weight: Floats,
    joints_m: Floats,
    variance: Floats,
    pairs: npt.NDArray[np.int64],
    learn_variance: float,
    memory_frames: float,
) -> None:
    for kind in range(len(pairs)):
        total, summed = 0.0, 0.0
        for side in range(pairs.shape[1]):
            a, b = pairs[kind, side]
            square = 0.0
            for k in range(3):
                square += (joints_m[b, k] - joints_m[a, k]) ** 2
            sure = learn_variance / max(variance[a] + variance[b], 1e-8)
            if np.isnan(square) or not sure >= 0.25:
                continue
            total += min(sure, 1.0)
            summed += min(sure, 1.0) * np.sqrt(square)
        if total > 0.0:
            kept = max(0.0, min(weight[kind], memory_frames - total))
            known_m = kept * length_m[kind] if kept > 0.0 else 0.0
            length_m[kind] = (known_m + summed) / (kept + total)
            weight[kind] = kept + total


def learn(bones: Bones, joints_m: Floats, spread_m: Floats, config: BonesConfig) -> Bones:
    """The lengths after one more frame: running means weighted by how surely both ends were found.

    joints_m: (20, 3), NaN unknown. spread_m: (20,).
    """
    length_m, weight = bones.length_m.copy(), bones.weight.copy()
    _learn(length_m, weight, joints_m, spread_m**2, PAIRS, config.learn_spread_m**2, float(config.memory_frames))
    return Bones(length_m, weight)


@nb.njit(cache=True, nogil=True)
def relax(
    joints_m: Floats, variance: Floats, pairs: npt.NDArray[np.int64], length_m: Floats, own: Floats, sweeps: int
) -> None:
    """Move joints (20, 3), in place, until bones agree with their lengths as far as both are known.

    variance: (20,). pairs: (kinds, sides, 2). length_m: (kinds,), NaN unknown; own: (kinds,) their variance.
    """
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


def known_lengths(bones: Bones, config: BonesConfig) -> Floats:
    """Lengths (KINDS,) of the bones that were seen often enough, NaN of the others."""
    return np.where(bones.weight >= config.least_frames, bones.length_m, np.nan)


def straighten(joints_m: Floats, spread_m: Floats, bones: Bones, config: BonesConfig) -> Floats:
    """The joints (20, 3), moved to agree with the bones as far as both are known."""
    out = joints_m.copy()
    own = config.tolerance_m**2 * (1.0 + config.least_frames / np.maximum(bones.weight, 1.0))
    relax(out, spread_m**2, PAIRS, known_lengths(bones, config), own, config.sweeps)
    return out
