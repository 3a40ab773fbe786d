"""From joint proposals to one body: the best combination of modes under bone lengths, exact on the tree of bones."""

from __future__ import annotations

from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.votes import Proposals
from teleop.config.body import SkeletonConfig
from teleop.joints import BONES

_PARENT: Final = np.array([a for a, _ in BONES], np.int64)
_CHILD: Final = np.array([b for _, b in BONES], np.int64)


@nb.njit(cache=True, nogil=True)
def best_modes(
    modes_m: npt.NDArray[np.float64],
    unary: npt.NDArray[np.float64],
    parent: npt.NDArray[np.int64],
    child: npt.NDArray[np.int64],
    bones_m: npt.NDArray[np.float64],
    tolerance: float,
) -> npt.NDArray[np.int64]:
    """Index (J,) of the mode of each joint that minimises the sum of unary and bone costs (dynamic programming).

    modes_m: (J, S, 3). unary: (J, S), inf where there is no mode. A bone's cost is the squared relative error of its
    length over ``tolerance``, cut at 9. Bones are listed from the root outwards.
    """
    joints, options = unary.shape
    cost = unary.copy()
    pick = np.zeros((len(child), options), np.int64)
    for b in range(len(child) - 1, -1, -1):
        p, c = parent[b], child[b]
        for i in range(options):
            best, best_k = np.inf, 0
            for k in range(options):
                if not np.isfinite(cost[c, k]):
                    continue
                pair = 0.0
                if np.isfinite(unary[p, i]):
                    d = modes_m[p, i] - modes_m[c, k]
                    relative = (np.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / bones_m[b] - 1.0) / tolerance
                    pair = min(relative * relative, 9.0)
                if cost[c, k] + pair < best:
                    best, best_k = cost[c, k] + pair, k
            pick[b, i] = best_k
            if np.isfinite(best):
                cost[p, i] += best
    choice = np.zeros(joints, np.int64)
    root = parent[0]
    choice[root] = np.argmin(cost[root])
    for b in range(len(child)):
        choice[child[b]] = pick[b, choice[parent[b]]]
    return choice


@nb.njit(cache=True, nogil=True)
def _forget_long(
    joints_m: npt.NDArray[np.float64],
    confidence: npt.NDArray[np.float64],
    parent: npt.NDArray[np.int64],
    child: npt.NDArray[np.int64],
    longest_m: npt.NDArray[np.float64],
) -> None:
    for bone in range(len(parent)):
        p, c = parent[bone], child[bone]
        square = 0.0
        for k in range(3):
            square += (joints_m[c, k] - joints_m[p, k]) ** 2
        if np.sqrt(square) > longest_m[bone]:  # False where one is unknown
            joints_m[c if confidence[c] <= confidence[p] else p] = np.nan


def without_long_bones(
    joints_m: npt.NDArray[np.float64], confidence: npt.NDArray[np.float64], longest_m: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Joints (20, 3) with the less sure end of every impossibly long bone unknown. longest_m: (B,)."""
    out = joints_m.copy()
    _forget_long(out, confidence, _PARENT, _CHILD, longest_m)
    return out


def assemble(
    proposals: Proposals,
    bones_m: npt.NDArray[np.float64],
    previous_m: npt.NDArray[np.float64] | None,
    config: SkeletonConfig,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """One position a joint. bones_m: (B,) expected lengths. previous_m: (20, 3) last frame, NaN unknown, or None.

    Returns joints (20, 3), NaN where the confidence is below the minimum, and confidence (20,) in 0..1.
    """
    scores, modes = proposals.scores, proposals.modes_m
    if config.enabled:
        with np.errstate(divide="ignore", invalid="ignore"):
            unary = -config.weight_power * np.log(scores / scores.max(axis=1, keepdims=True))
        if previous_m is not None:
            moved = np.linalg.norm(modes - previous_m[:, None, :], axis=2)
            unary = unary + np.where(np.isnan(moved), 0.0, np.minimum((moved / config.previous_scale_m) ** 2, 4.0))
        unary[np.isnan(unary) | np.isnan(modes[..., 0])] = np.inf
        choice = best_modes(modes, unary, _PARENT, _CHILD, bones_m, config.bone_tolerance)
    else:
        choice = np.zeros(len(scores), np.int64)
    rows = np.arange(len(scores))
    confidence = np.clip(scores[rows, choice], 0.0, 1.0)
    joints = modes[rows, choice].copy()
    confidence = np.where(np.isnan(joints[:, 0]), 0.0, confidence)
    joints[confidence < config.min_confidence] = np.nan
    if config.enabled:
        joints = without_long_bones(joints, confidence, config.max_bone * bones_m)
        confidence = np.where(np.isnan(joints[:, 0]), np.minimum(confidence, config.min_confidence), confidence)
    return joints, confidence
