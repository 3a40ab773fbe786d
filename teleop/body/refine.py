"""Joints refined from the depth round them: a small network looks at a metric crop at each proposed joint.

Stage two of a cascade (after Sun et al., CVPR 2015, pose-indexed features): the forest's proposals are good to a few
centimetres, and what is left of their error is plain to see once the window is centred on them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.crop import LOCAL, crop_cells
from teleop.body.layers import F32, Convolution, convolve, rectify
from teleop.joints import BONES, JOINT_NAMES, MIRROR_JOINT, N_JOINTS

N_NEAR: Final = 5
STEP_M: Final = 0.1
"""Metres that an output of 1 moves a joint."""
SPREAD_M: Final = 0.02
"""Metres of a log spread of 0."""

Floats = npt.NDArray[np.float64]


def _near() -> npt.NDArray[np.int64]:
    """The joints (J, N_NEAR) fewest bones away, the same roles on both sides of the body."""
    steps = np.full((N_JOINTS, N_JOINTS), 99)
    np.fill_diagonal(steps, 0)
    for a, b in BONES:
        steps[a, b] = steps[b, a] = 1
    for via in range(N_JOINTS):
        steps = np.minimum(steps, steps[:, [via]] + steps[[via], :])
    out = np.zeros((N_JOINTS, N_NEAR), np.int64)
    for j, name in enumerate(JOINT_NAMES):
        if name.endswith("_left"):
            continue

        def order(k: int, j: int = j) -> tuple[int, int, str, bool]:
            side = JOINT_NAMES[k].rsplit("_", 1)[-1]
            own = 0 if side not in ("right", "left") else 1 if side == JOINT_NAMES[j].rsplit("_", 1)[-1] else 2
            base = JOINT_NAMES[k].removesuffix("_left").removesuffix("_right")
            return int(steps[j, k]), own, base, side != "right"

        out[j] = sorted((k for k in range(N_JOINTS) if k != j), key=order)[:N_NEAR]
        if name.endswith("_right"):
            out[MIRROR_JOINT[j]] = np.array(MIRROR_JOINT)[out[j]]
    return out


NEAR: Final = _near()
IS_LEFT: Final = np.array([name.endswith("_left") for name in JOINT_NAMES])
"""Joints whose crop is mirrored: one network serves both sides."""
KINDS: Final = tuple(name for name in JOINT_NAMES if not name.endswith("_left"))
KIND: Final = np.array([KINDS.index(name.replace("_left", "_right")) for name in JOINT_NAMES])
"""Index (J,) of each joint's kind: a joint and its mirror image are one."""


@dataclass(frozen=True, slots=True, eq=False)
class Refiner:
    """The network. K kinds of joints.

    convolutions: over the crops. first: (features + 3 N_NEAR, H1) and first_bias (K, H1), one bias a kind.
    second: (H1, H2), second_bias (H2,). last: (K, H2, 4), last_bias (K, 4): move in STEP_M, log spread.
    """

    convolutions: tuple[Convolution, ...]
    first: F32
    first_bias: F32
    second: F32
    second_bias: F32
    last: F32
    last_bias: F32


@nb.njit(cache=True, nogil=True)
def joint_crops(
    flat_mm: npt.NDArray[np.int16],
    first: int,
    width: int,
    height: int,
    intrinsics: Floats,
    joints_m: Floats,
    mirror: npt.NDArray[np.bool_],
    shape: tuple[int, int, float, float, float, float],
) -> F32:
    """Crops (N, rows, columns, 2) of one image centred on joints (N, 3).

    flat_mm, first, width, height: the image, see crop_cells. intrinsics: fx, fy, cx, cy counted from its first pixel.
    """
    rows, columns, cell_m, unit_m, near, far = shape
    out = np.empty((len(joints_m), rows, columns, 2), np.float32)
    fx, fy, cx, cy = intrinsics
    for k in range(len(joints_m)):
        x, y, z = joints_m[k]
        column, row = cx + fx * x / z, cy - fy * y / z
        out[k] = crop_cells(
            flat_mm,
            first,
            width,
            height,
            column,
            row,
            z,
            fx,
            fy,
            mirror[k],
            rows,
            columns,
            cell_m,
            unit_m,
            near,
            far,
        )
    return out


def near_vectors(joints_m: Floats) -> F32:
    """Vectors (J, 3 N_NEAR) to the neighbours, mirrored for joints of the left side."""
    vectors = joints_m[NEAR] - joints_m[:, None, :]
    vectors[IS_LEFT, :, 0] *= -1.0
    return vectors.reshape(len(joints_m), -1).astype(np.float32)


def moves(refiner: Refiner, crops: F32, near: F32, kind: npt.NDArray[np.int64]) -> tuple[Floats, Floats]:
    """How far N joints are off (N, 3) in metres, in the orientation of their crops, and the spread (N,) left over.

    crops: (N, rows, columns, 2). near: (N, 3 N_NEAR). kind: (N,) index into KINDS.
    """
    values = crops
    for layer in refiner.convolutions:
        values = convolve(layer, values)
    hidden = np.concatenate([values.reshape(len(values), -1), near], axis=1) @ refiner.first
    hidden = np.maximum(hidden + refiner.first_bias[kind], np.float32(0))
    hidden = hidden @ refiner.second
    rectify(hidden, refiner.second_bias)
    out = np.matmul(hidden[:, None, :], refiner.last[kind])[:, 0] + refiner.last_bias[kind]
    return out[:, :3].astype(np.float64) * STEP_M, np.exp(out[:, 3].astype(np.float64)) * SPREAD_M


def refine(
    refiner: Refiner,
    flat_mm: npt.NDArray[np.int16],
    width: int,
    height: int,
    intrinsics: Floats,
    joints_m: Floats,
    which: npt.NDArray[np.int64],
) -> tuple[Floats, Floats]:
    """Places (N, 3) of the joints ``which`` (N,), moved to where the depth round them says, and the spread (N,) in
    metres of what is left.

    flat_mm: canonical image of the operator, row by row. intrinsics: fx, fy, cx, cy counted from its first pixel.
    joints_m: (20, 3), all known, before the sensor.
    """
    s, left = LOCAL, IS_LEFT[which]
    shape = (s.rows, s.columns, s.cell_m, s.unit_m, s.near, s.far)
    crops = joint_crops(flat_mm, 0, width, height, intrinsics, joints_m[which], left, shape)
    move, spread = moves(refiner, crops, near_vectors(joints_m)[which], KIND[which])
    move[left, 0] *= -1.0
    return joints_m[which] + move, spread
