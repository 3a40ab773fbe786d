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


def offset_unit(focal_px: float) -> float:
    """Pixels times mm of depth that 0.1 mm of feature offset spans."""
    return focal_px * 1000.0 * OFFSET_UNIT_M


@nb.njit(cache=True, nogil=True)
def walk(
    flat_mm: npt.NDArray[np.int16],
    at: npt.NDArray[np.int64],
    image: npt.NDArray[np.int32],
    widths: npt.NDArray[np.int32],
    unit_x: npt.NDArray[np.float32],
    unit_y: npt.NDArray[np.float32],
    root: int,
    max_depth: int,
    nodes: npt.NDArray[np.int16],
    leaves: npt.NDArray[np.int32],
) -> npt.NDArray[np.int32]:
    """Leaf (N,) of each pixel in one tree.

    flat_mm: padded image(s), see depth_difference. at: (N,) the pixels. image: (N,) index of each pixel's image.
    widths, unit_x, unit_y: of the images; a unit is pixels times mm per 0.1 mm of offset, the depth is divided out
    here; a negative unit_x walks the mirrored image. nodes: see teleop.body.model.pack_nodes.
    """
    n = len(at)
    out = np.empty(n, np.int32)
    children = nodes.view(np.int32)
    node = np.empty(LANES, np.int32)
    place = np.empty(LANES, np.int64)
    width = np.empty(LANES, np.int64)
    sx = np.empty(LANES, np.float32)
    sy = np.empty(LANES, np.float32)
    for start in range(0, n, LANES):
        lanes = min(LANES, n - start)
        for k in range(lanes):
            place[k] = at[start + k]
            m = image[start + k]
            depth = np.float32(flat_mm[place[k]])
            width[k] = widths[m]
            sx[k] = unit_x[m] / depth
            sy[k] = unit_y[m] / depth
            node[k] = root
        for _ in range(max_depth):
            moving = False
            for k in range(lanes):
                i = node[k]
                f = depth_difference(flat_mm, place[k], width[k], sx[k], sy[k], nodes, i)
                # a leaf is its own child and its threshold is never reached, so it stays
                node[k] = children[i, 3] + np.int32(f >= nodes[i, 4])
                moving |= node[k] != i
            if not moving:
                break
        for k in range(lanes):
            out[start + k] = leaves[node[k]]
    return out


def forest_leaves(model: BodyModel, image: PaddedImage, where: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
    """Leaves (T, N) that N pixels, rows and columns (N, 2) of the image, reach in T trees."""
    width = image.depth_mm.shape[1]
    at = where[:, 0].astype(np.int64) * width + where[:, 1]
    one = np.zeros(len(where), np.int32)
    widths = np.array([width], np.int32)
    unit_x, unit_y = (np.array([offset_unit(f)], np.float32) for f in (image.fx, image.fy))
    out = np.empty((len(model.roots), len(where)), np.int32)
    for tree, root in enumerate(model.roots):
        out[tree] = walk(
            image.depth_mm.reshape(-1),
            at,
            one,
            widths,
            unit_x,
            unit_y,
            int(root),
            model.max_depth,
            model.nodes,
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
    model: BodyModel, image: PaddedImage, stride: int, step: int, mirrored: bool
) -> tuple[BodyParts, npt.NDArray[np.int32]]:
    """Run the forest over every stride-th pixel of the image.

    step, mirrored: how the image was made from the camera's, to give the pixels back in the camera's columns and
    rows. Returns the parts and the leaves (T, N).
    """
    where = body_pixels(image.depth_mm, stride)
    leaves = forest_leaves(model, image, where)
    u = (where[:, 1] + np.int32(image.u0)) * np.int32(step)
    parts = BodyParts(
        u=u if mirrored else -u,
        v=(where[:, 0] + np.int32(image.v0)) * np.int32(step),
        points_m=body_points(image, where),
        probability=mean_parts(leaves, model.leaf_parts),
        stride=stride * step,
    )
    return parts, leaves
