"""Lazy forest inference: only the features on a pixel's own path are computed (source eq. (2)).

Eight pixels walk down a tree side by side, so that the memory latency of one hides behind the others.
"""

from __future__ import annotations

from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.features import PaddedImage, body_pixels, body_points, depth_difference
from teleop.body.model import OFFSET_UNIT_M, BodyModel
from teleop.skeleton import BodyParts

LANES: Final = 8
MILLIMETRES: Final = 1000.0


@nb.njit(cache=True, nogil=True)
def walk(
    depth_mm: npt.NDArray[np.int16],
    where: npt.NDArray[np.int32],
    unit_x: float,
    unit_y: float,
    root: int,
    max_depth: int,
    offsets: npt.NDArray[np.int16],
    thresholds_mm: npt.NDArray[np.int16],
    children: npt.NDArray[np.int32],
    leaves: npt.NDArray[np.int32],
) -> npt.NDArray[np.int32]:
    """Leaf (N,) of each pixel in one tree. unit: pixels times mm per 0.1 mm of offset, the depth divided out here."""
    n = len(where)
    out = np.empty(n, np.int32)
    node = np.empty(LANES, np.int32)
    sx = np.empty(LANES, np.float32)
    sy = np.empty(LANES, np.float32)
    for start in range(0, n, LANES):
        lanes = min(LANES, n - start)
        for k in range(lanes):
            depth = np.float32(depth_mm[where[start + k, 0], where[start + k, 1]])
            sx[k] = np.float32(unit_x) / depth
            sy[k] = np.float32(unit_y) / depth
            node[k] = root
        for _ in range(max_depth):
            moving = False
            for k in range(lanes):
                i = node[k]
                f = depth_difference(depth_mm, where[start + k, 0], where[start + k, 1], sx[k], sy[k], offsets, i)
                # a leaf is its own child and its threshold is never reached, so it stays
                node[k] = children[i] + np.int32(f >= thresholds_mm[i])
                moving |= node[k] != i
            if not moving:
                break
        for k in range(lanes):
            out[start + k] = leaves[node[k]]
    return out


def forest_leaves(model: BodyModel, image: PaddedImage, where: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
    """Leaves (T, N) that N pixels, rows and columns (N, 2) of the image, reach in T trees."""
    unit_x, unit_y = (f * MILLIMETRES * OFFSET_UNIT_M for f in (image.fx, image.fy))
    out = np.empty((len(model.roots), len(where)), np.int32)
    for tree, root in enumerate(model.roots):
        out[tree] = walk(
            image.depth_mm,
            where,
            unit_x,
            unit_y,
            int(root),
            model.max_depth,
            model.offsets,
            model.thresholds_mm,
            model.children,
            model.leaves,
        )
    return out


@nb.njit(cache=True, nogil=True)
def mean_parts(leaves: npt.NDArray[np.int32], leaf_parts: npt.NDArray[np.uint8]) -> npt.NDArray[np.float32]:
    """Part probabilities (N, P), the mean over the trees (source eq. (2)); rows sum to 1."""
    trees, n = leaves.shape
    parts = leaf_parts.shape[1]
    out = np.zeros((n, parts), np.float32)
    for i in range(n):
        total = np.float32(0)
        for t in range(trees):
            leaf = leaves[t, i]
            for p in range(parts):
                value = np.float32(leaf_parts[leaf, p])
                out[i, p] += value
                total += value
        if total > 0:
            for p in range(parts):
                out[i, p] /= total
    return out


def stride_for(area_px: int, max_pixels: int) -> int:
    """Smallest pixel step that evaluates at most about ``max_pixels`` of ``area_px`` pixels."""
    return max(1, int(np.ceil(np.sqrt(area_px / max_pixels))))


def infer(
    model: BodyModel, image: PaddedImage, stride: int, width: int | None
) -> tuple[BodyParts, npt.NDArray[np.int32]]:
    """Run the forest over every stride-th pixel of the operator.

    width: the camera image's width where that image is unmirrored, to give the pixels back in its own columns;
    None for a mirrored one, which is canonical already. Returns the parts and the leaves (T, N).
    """
    where = body_pixels(image.depth_mm, stride)
    leaves = forest_leaves(model, image, where)
    u = where[:, 1] + np.int32(image.u0)
    parts = BodyParts(
        u=u if width is None else np.int32(width - 1) - u,
        v=where[:, 0] + np.int32(image.v0),
        points_m=body_points(image, where),
        probability=mean_parts(leaves, model.leaf_parts),
        stride=stride,
    )
    return parts, leaves
