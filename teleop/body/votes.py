"""Every pixel votes for joints: pixel position plus the offset its leaf learned (Girshick 2011).

This replaces the push back along z: a vote lands inside the body, and also where the joint is hidden.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.meanshift import find_modes
from teleop.body.model import SPREAD_UNIT_M, BodyModel
from teleop.config.body import ProposalConfig
from teleop.joints import N_JOINTS


@dataclass(frozen=True, slots=True, eq=False)
class Proposals:
    """Joint proposals of one frame, best first.

    modes_m: (J, S, 3) skeleton space, NaN where there are fewer. scores: (J, S) summed vote weight, relative to that
    of a well-seen joint.
    """

    modes_m: npt.NDArray[np.float64]
    scores: npt.NDArray[np.float64]


def vote_weights(config: ProposalConfig) -> npt.NDArray[np.float32]:
    """Weight (256,) of a vote by its leaf's spread code."""
    spread_m = np.arange(256) * SPREAD_UNIT_M
    weights = (1.0 + (spread_m / config.spread_scale_m) ** 2) ** -config.spread_power
    return weights.astype(np.float32)


@nb.njit(cache=True, nogil=True)
def gather_votes(
    points_m: npt.NDArray[np.float32],
    leaves: npt.NDArray[np.int32],
    vote_joint: npt.NDArray[np.uint8],
    vote_mm: npt.NDArray[np.int16],
    vote_spread: npt.NDArray[np.uint8],
    weight_of: npt.NDArray[np.float32],
    max_points: int,
    joints: int,
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32], npt.NDArray[np.int32], npt.NDArray[np.float64]]:
    """The surest votes of each joint.

    Two passes: the first counts votes by spread code, the second keeps those up to the code that fills
    ``max_points``, evenly thinned at that last code. Returns points (J, 3, max_points), weights (J, max_points)
    holding d^2 (source eq. (3)), counts (J,) and the total weight (J,) of all votes.
    """
    trees, n = leaves.shape
    slots = vote_joint.shape[1]
    histogram = np.zeros((joints, 256), np.int32)
    for t in range(trees):
        for i in range(n):
            leaf = leaves[t, i]
            for k in range(slots):
                j = vote_joint[leaf, k]
                if j < joints:
                    histogram[j, vote_spread[leaf, k]] += 1
    last = np.full(joints, 255, np.int32)
    keep_every = np.ones(joints, np.float32)
    for j in range(joints):
        total = 0
        for code in range(256):
            h = histogram[j, code]
            if total + h > max_points:
                last[j] = code
                keep_every[j] = h / np.float32(max_points - total) if total < max_points else np.float32(1e9)
                break
            total += h
    out = np.empty((joints, 3, max_points), np.float32)
    weights = np.empty((joints, max_points), np.float32)
    counts = np.zeros(joints, np.int32)
    seen = np.zeros(joints, np.int32)
    taken = np.zeros(joints, np.int32)
    mass = np.zeros(joints)
    for t in range(trees):
        for i in range(n):
            leaf = leaves[t, i]
            d2 = points_m[i, 2] * points_m[i, 2]
            for k in range(slots):
                j = vote_joint[leaf, k]
                if j >= joints:
                    continue
                code = vote_spread[leaf, k]
                w = weight_of[code] * d2
                mass[j] += w
                if code > last[j]:
                    continue
                if code == last[j]:
                    seen[j] += 1
                    if seen[j] < np.float32(taken[j] + 1) * keep_every[j]:
                        continue
                    taken[j] += 1
                c = counts[j]
                if c < max_points:
                    for a in range(3):
                        out[j, a, c] = points_m[i, a] + vote_mm[leaf, k, a] * np.float32(1e-3)
                    weights[j, c] = w
                    counts[j] = c + 1
    return out, weights, counts, mass


@nb.njit(cache=True, nogil=True)
def all_modes(
    points_m: npt.NDArray[np.float32],
    weights: npt.NDArray[np.float32],
    counts: npt.NDArray[np.int32],
    bandwidth_m: npt.NDArray[np.float64],
    starts: int,
    iterations: int,
    tolerance_m: float,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Modes (J, S, 3) and the share (J, S) of the kept weight that lies at each."""
    joints = len(counts)
    modes = np.full((joints, starts, 3), np.nan)
    shares = np.zeros((joints, starts))
    for j in range(joints):
        c = counts[j]
        if c > 0:
            w = weights[j, :c]
            m, s = find_modes(points_m[j], w, bandwidth_m[j], starts, iterations, tolerance_m)
            modes[j] = m
            shares[j] = s / w.sum()
    return modes, shares


def propose(
    model: BodyModel,
    points_m: npt.NDArray[np.float32],
    leaves: npt.NDArray[np.int32],
    stride_px: float,
    focal_px: float,
    weight_of: npt.NDArray[np.float32],
    config: ProposalConfig,
) -> Proposals:
    """Joint proposals from the pixels' leaves.

    points_m: (N, 3). leaves: (T, N). stride_px, focal_px: a pixel stands for ``(stride * z / focal)^2`` of surface,
    which makes the scores independent of resolution, stride and distance. weight_of: from vote_weights().
    """
    points, weights, counts, mass = gather_votes(
        points_m, leaves, model.vote_joint, model.vote_mm, model.vote_spread, weight_of, config.max_points, N_JOINTS
    )
    modes, shares = all_modes(
        points, weights, counts, model.bandwidth_m, config.starts, config.iterations, config.tolerance_m
    )
    surface = mass * (stride_px / focal_px) ** 2 / len(leaves)
    return Proposals(modes, shares * (surface / model.reference)[:, None])
