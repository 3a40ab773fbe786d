"""All joints at once from the whole operator: a small convolutional network over one metric crop.

Every cell of its last layer is an anchor that votes for every joint (after A2J: Xiong et al., ICCV 2019): it knows
what the operator's pose is as a whole, so it finds the hand that a pixel's surroundings alone cannot tell.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.crop import WHOLE, body_centre, sample_crop
from teleop.body.features import Pixels
from teleop.body.layers import F32, Stack, run_stack
from teleop.joints import N_JOINTS

REACH_M: Final = 0.3
"""Metres that an anchor's output of 1 lies from the anchor."""
SPREAD_M: Final = 0.05
"""Metres of a log spread of 0."""
N_OUTPUTS: Final = 5
"""Of an anchor for a joint: vote weight (logit), offsets right, down and in depth, log spread."""

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class CoarseNet:
    """stack: from the crop to the anchors. head: (channels, J * N_OUTPUTS). head_bias: (J * N_OUTPUTS,)."""

    stack: Stack
    head: F32
    head_bias: F32


def anchor_places(rows: int, columns: int) -> F32:
    """Places (A, 2) in metres right of and below the crop's centre."""
    cell_y, cell_x = WHOLE.rows / rows * WHOLE.cell_m, WHOLE.columns / columns * WHOLE.cell_m
    y, x = np.mgrid[:rows, :columns].astype(np.float32)
    places = np.stack([(x + 0.5 - 0.5 * columns) * cell_x, (y + 0.5 - 0.5 * rows) * cell_y], axis=-1)
    return places.reshape(-1, 2).astype(np.float32)


def from_crop(places_m: Floats, centre: tuple[float, float, float], intrinsics: Floats) -> Floats:
    """Skeleton-space joints (J, 3) of places in the crop: right, down and deeper than its centre, in metres.

    centre: column, row and depth; see body_centre. intrinsics: fx, fy, cx, cy.
    """
    column, row, depth_m = centre
    fx, fy, cx, cy = intrinsics
    z = depth_m + places_m[:, 2]
    x = (places_m[:, 0] / depth_m + (column - cx) / fx) * z
    y = -(places_m[:, 1] / depth_m + (row - cy) / fy) * z
    return np.stack([x, y, z], axis=1)


def to_crop(joints_m: Floats, centre: tuple[float, float, float], intrinsics: Floats) -> Floats:
    """The inverse of from_crop."""
    column, row, depth_m = centre
    fx, fy, cx, cy = intrinsics
    z = joints_m[:, 2]
    right = (joints_m[:, 0] / z - (column - cx) / fx) * depth_m
    down = (-joints_m[:, 1] / z - (row - cy) / fy) * depth_m
    return np.stack([right, down, z - depth_m], axis=1)


@nb.njit(cache=True, nogil=True)
def _places(
    crop: F32,
    kernels: tuple[F32, ...],
    biases: tuple[F32, ...],
    shape: npt.NDArray[np.int64],
    head: F32,
    head_bias: F32,
    anchors: F32,
    joints: int,
) -> tuple[Floats, Floats]:
    values = run_stack(crop.reshape(1, crop.shape[0], crop.shape[1], crop.shape[2]), kernels, biases, shape)
    out = np.dot(values.reshape(-1, values.shape[3]), head)
    found, spread = np.zeros((joints, 3)), np.zeros(joints)
    for j in range(joints):
        most = np.float32(-np.inf)
        for a in range(len(anchors)):
            most = max(most, out[a, j * N_OUTPUTS])
        total = 0.0
        for a in range(len(anchors)):
            weight = np.exp(np.float64(out[a, j * N_OUTPUTS] - most))
            total += weight
            for k in range(3):
                voted = np.float64(out[a, j * N_OUTPUTS + 1 + k] + head_bias[j * N_OUTPUTS + 1 + k]) * REACH_M
                found[j, k] += weight * (voted + anchors[a, k] if k < 2 else voted)
            spread[j] += weight * np.float64(out[a, j * N_OUTPUTS + 4] + head_bias[j * N_OUTPUTS + 4])
        found[j] /= total
        spread[j] = np.exp(spread[j] / total) * SPREAD_M
    return found, spread


@lru_cache(maxsize=4)
def _anchors(shape: tuple[int, ...]) -> F32:
    """Anchors of a stack with these strides."""
    rows, columns = WHOLE.rows, WHOLE.columns
    for stride in shape:
        rows, columns = -(-rows // stride), -(-columns // stride)
    return anchor_places(rows, columns)


def places(net: CoarseNet, crop: F32) -> tuple[Floats, Floats]:
    """Places (J, 3) in the crop, see from_crop, and their spread (J,) in metres. crop: (rows, columns, 2)."""
    stack = net.stack
    anchors = _anchors(tuple(layer.stride for layer in stack.layers))
    found, spread = _places(crop, stack.kernels, stack.biases, stack.shape, net.head, net.head_bias, anchors, N_JOINTS)
    return found, spread


def whole_crop(image: Pixels, centre: tuple[float, float, float], mirror: bool = False) -> F32:
    """The network's crop (rows, columns, 2) of the operator about a centre, see body_centre."""
    out = np.empty((WHOLE.rows, WHOLE.columns, 2), np.float32)
    focal = (float(image.intrinsics[0]), float(image.intrinsics[1]))
    sample_crop(image.flat_mm, image.first, image.width, image.height, centre, focal, mirror, WHOLE.tuple(), out)
    return out


def locate(net: CoarseNet, image: Pixels) -> tuple[Floats, Floats]:
    """All joints (20, 3) of the operator, seen or not, and their spread (20,) in metres."""
    centre = body_centre(image)
    found, spread = places(net, whole_crop(image, centre))
    return from_crop(found, centre, image.intrinsics), spread
