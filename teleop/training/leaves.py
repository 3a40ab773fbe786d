"""What a leaf learns: the distribution of parts, and where the joints lie from its pixels (Girshick 2011)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.forest import walk
from teleop.body.model import OFFSET_UNIT_M, SPREAD_UNIT_M, pack_nodes
from teleop.body.parts import N_PARTS
from teleop.joints import MIRROR_JOINT, N_JOINTS
from teleop.training.images import Images, Pixels
from teleop.training.trainer import Tree

ROBUST_M: Final = 0.06
"""Distance at which an offset begins to count as another mode (Cauchy weights)."""
CUT_M: Final = 0.5
"""An offset farther than this from the mode adds no more to the spread."""


@dataclass(frozen=True, slots=True, eq=False)
class Leaves:
    """Leaf contents as in BodyModel."""

    parts: npt.NDArray[np.uint8]
    vote_joint: npt.NDArray[np.uint8]
    vote_mm: npt.NDArray[np.int16]
    vote_spread: npt.NDArray[np.uint8]


@nb.njit(cache=True, nogil=True, parallel=True)
def _votes(
    offsets_m: npt.NDArray[np.float32],
    order: npt.NDArray[np.int64],
    begin: npt.NDArray[np.int64],
    slots: int,
    robust_m: float,
    cut_m: float,
) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """The ``slots`` most certain joints of each leaf: joint, offset and spread. offsets_m: (N, J, 3)."""
    count, joints = len(begin) - 1, offsets_m.shape[1]
    chosen = np.full((count, slots), joints, np.uint8)
    mode_out = np.zeros((count, slots, 3), np.float32)
    spread_out = np.zeros((count, slots), np.float32)
    for leaf in nb.prange(count):
        members = order[begin[leaf] : begin[leaf + 1]]
        n = len(members)
        if n == 0:
            continue
        modes = np.zeros((joints, 3))
        spreads = np.full(joints, np.inf)
        for j in range(joints):
            m = np.zeros(3)
            for i in range(n):
                for a in range(3):
                    m[a] += offsets_m[members[i], j, a] / n
            for _ in range(6):
                s = np.zeros(3)
                total = 0.0
                for i in range(n):
                    o = offsets_m[members[i], j]
                    d2 = (o[0] - m[0]) ** 2 + (o[1] - m[1]) ** 2 + (o[2] - m[2]) ** 2
                    w = 1.0 / (1.0 + d2 / (robust_m * robust_m))
                    total += w
                    for a in range(3):
                        s[a] += w * o[a]
                m = s / total
            square = 0.0
            for i in range(n):
                o = offsets_m[members[i], j]
                d2 = (o[0] - m[0]) ** 2 + (o[1] - m[1]) ** 2 + (o[2] - m[2]) ** 2
                square += min(d2, cut_m * cut_m)
            modes[j] = m
            # a prior of two pixels at 0.15 m keeps small leaves from seeming certain
            spreads[j] = np.sqrt((square + 2 * 0.15**2) / (n + 2))
        best = np.argsort(spreads)
        for k in range(slots):
            chosen[leaf, k] = best[k]
            mode_out[leaf, k] = modes[best[k]].astype(np.float32)
            spread_out[leaf, k] = spreads[best[k]]
    return chosen, mode_out, spread_out


def tree_leaves(images: Images, pixels: Pixels, tree: Tree) -> npt.NDArray[np.int32]:
    """Leaf (N,) of each training pixel."""
    mirrored = np.concatenate([np.ones(len(images)), -np.ones(len(images))])
    unit = np.tile(images.focal_px, 2) * 1000.0 * OFFSET_UNIT_M
    return walk(
        images.flat_mm,
        pixels.at,
        pixels.frame,
        np.tile(images.widths, 2),
        (unit * mirrored).astype(np.float32),
        unit.astype(np.float32),
        0,
        tree.max_depth,
        pack_nodes(tree.offsets, tree.thresholds_mm, tree.children),
        tree.leaves,
    )


def joint_offsets(images: Images, pixels: Pixels) -> npt.NDArray[np.float32]:
    """Joint minus pixel (N, 20, 3) in metres; for mirrored pixels in the mirrored world."""
    count = len(images)
    f = pixels.frame % count
    local = pixels.at - images.starts[f]
    row, column = local // images.widths[f], local % images.widths[f]
    z = images.flat_mm[pixels.at] * 1e-3
    x = (column + images.u0[f] - images.cx[f]) * z / images.focal_px[f]
    y = -(row + images.v0[f] - images.cy[f]) * z / images.focal_px[f]
    point = np.stack([x, y, z], axis=1).astype(np.float32)
    joints = images.joints_m.astype(np.float32)
    flipped = joints[:, list(MIRROR_JOINT)] * np.array([-1, 1, 1], np.float32)
    both = np.concatenate([joints, flipped])
    point[pixels.frame >= count, 0] *= -1
    return both[pixels.frame] - point[:, None, :]


def fill_leaves(images: Images, pixels: Pixels, tree: Tree, slots: int) -> Leaves:
    """Contents of a tree's leaves from (many) pixels. slots: votes a leaf, the most certain joints."""
    reached = tree_leaves(images, pixels, tree)
    count = int(tree.leaves.max()) + 1
    parts = np.bincount(reached * np.int64(N_PARTS) + pixels.part, minlength=count * N_PARTS).reshape(count, N_PARTS)
    share = parts / np.maximum(parts.sum(axis=1, keepdims=True), 1)
    order = np.argsort(reached, kind="stable")
    begin = np.concatenate([[0], np.cumsum(np.bincount(reached, minlength=count))])
    joint, mode_m, spread_m = _votes(joint_offsets(images, pixels), order, begin, slots, ROBUST_M, CUT_M)
    joint[joint >= N_JOINTS] = N_JOINTS
    return Leaves(
        parts=np.round(share * 255).astype(np.uint8),
        vote_joint=joint,
        vote_mm=np.clip(np.round(mode_m * 1000), -32000, 32000).astype(np.int16),
        vote_spread=np.clip(np.round(spread_m / SPREAD_UNIT_M), 0, 255).astype(np.uint8),
    )
