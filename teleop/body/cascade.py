"""From the operator's depth image and the forest's joints to the final joints of one frame.

The coarse network places every joint, the refiner moves each to where the depth round it says; where the forest is of
another opinion, both are refined and the surer one is taken; at last arms and legs are looked at as wholes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.body.chains import ChainNet, straighten
from teleop.body.coarse import CoarseNet, locate
from teleop.body.features import PaddedImage
from teleop.body.refine import Refiner, refine
from teleop.config.body import CascadeConfig
from teleop.joints import JOINT_NAMES, N_JOINTS

N_CUES: Final = 6
NEAREST_M: Final = 0.3
"""Nothing is nearer to the sensor: a joint found there is put here before it is looked at."""
_ALL: Final = np.arange(N_JOINTS)
_ENDS: Final = np.array(
    [j for j, n in enumerate(JOINT_NAMES) if n.split("_")[0] in ("elbow", "wrist", "hand", "knee", "ankle", "foot")]
)
"""Joints that are looked at a second time, now from nearer."""

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Cascade:
    """coarse, refiner, limbs (of arms and of legs): the networks. trust: (N_CUES + 1,) weights of a logistic
    regression, see trust_cues."""

    coarse: CoarseNet
    refiner: Refiner
    limbs: tuple[ChainNet, ChainNet]
    trust: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """joints_m: (20, 3), none unknown. cues: (20, N_CUES) of how well each is known, see trust_cues."""

    joints_m: Floats
    cues: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What the networks find by themselves: coarse joints (20, 3) and their spread (20,), refined ones and theirs, and
    the image they looked at: pixels row by row, width, height, intrinsics."""

    coarse_m: Floats
    coarse_spread_m: Floats
    joints_m: Floats
    spread_m: Floats
    flat_mm: npt.NDArray[np.int16]
    width: int
    height: int
    intrinsics: Floats


def _look(
    cascade: Cascade,
    image: tuple[npt.NDArray[np.int16], int, int, Floats],
    joints_m: Floats,
    which: npt.NDArray[np.int64],
) -> tuple[Floats, Floats]:
    joints_m[:, 2] = np.maximum(joints_m[:, 2], NEAREST_M)
    return refine(cascade.refiner, *image, joints_m, which)


def see(cascade: Cascade, image: PaddedImage, config: CascadeConfig) -> Seen:
    """Find the joints of one frame without the forest."""
    inner = image.inner()
    view = (inner.reshape(-1), inner.shape[1], inner.shape[0], image.inner_intrinsics())
    coarse_m, coarse_spread = locate(cascade.coarse, *view)
    joints_m, spread = _look(cascade, view, coarse_m.copy(), _ALL)
    if config.second_look:
        joints_m[_ENDS], spread[_ENDS] = _look(cascade, view, joints_m, _ENDS)
    return Seen(coarse_m, coarse_spread, joints_m, spread, *view)


def settle(cascade: Cascade, seen: Seen, forest_m: Floats, config: CascadeConfig) -> Placed:
    """Joints of one frame from what the networks and the forest found. forest_m: (20, 3), NaN unknown."""
    joints_m, spread = seen.joints_m.copy(), seen.spread_m.copy()
    view = (seen.flat_mm, seen.width, seen.height, seen.intrinsics)
    moved = np.linalg.norm(joints_m - seen.coarse_m, axis=1)
    apart = np.linalg.norm(forest_m - joints_m, axis=1)
    other = np.flatnonzero(apart > config.opinion_m)  # False where the forest knows nothing
    if len(other):
        opinion = joints_m.copy()
        opinion[other] = forest_m[other]
        opinion[other], other_spread = _look(cascade, view, opinion, other)
        surer = other_spread < config.opinion_ratio * spread[other]
        taken = other[surer]
        joints_m[taken], spread[taken] = opinion[taken], other_spread[surer]
        apart[taken] = np.linalg.norm(forest_m[taken] - joints_m[taken], axis=1)
    if config.limbs:
        joints_m[:, 2] = np.maximum(joints_m[:, 2], NEAREST_M)
        joints_m, spread = straighten(cascade.limbs, *view, joints_m, spread)
    return Placed(joints_m, trust_cues(seen.coarse_spread_m, spread, moved, apart))


def trust_cues(coarse_spread_m: Floats, spread_m: Floats, moved_m: Floats, apart_m: Floats) -> Floats:
    """What tells how well a joint is known (20, N_CUES): logarithms of both networks' spreads, of how far the first
    look moved the joint and how far it is from the forest's (0.3 m where the forest knows nothing), and two squares."""
    apart = np.log(0.02 + np.minimum(np.nan_to_num(apart_m, nan=0.3), 0.5))
    coarse, fine = np.log(coarse_spread_m / 0.05), np.log(spread_m / 0.02)
    return np.stack([coarse, fine, np.log(0.01 + moved_m), apart, coarse**2, fine**2], axis=1)


def trust(cues: Floats, weights: Floats) -> Floats:
    """Confidence (20,): the probability that a joint is within 10 cm of the true one."""
    return np.asarray(1.0 / (1.0 + np.exp(-np.clip(cues @ weights[:-1] + weights[-1], -30.0, 30.0))))
