"""Arms and legs as wholes: what is seen round all joints of a limb tells best how it is bent.

Last stage of the cascade. One network looks at both arms, one at both legs; left limbs are mirrored.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.body.crop import LOCAL
from teleop.body.layers import F32, Convolution, convolve, rectify
from teleop.body.refine import SPREAD_M, STEP_M, joint_crops
from teleop.joints import JOINT_INDEX, MIRROR_JOINT

Floats = npt.NDArray[np.float64]

_NAMES: Final = (("shoulder", "elbow", "wrist", "hand"), ("hip", "knee", "ankle", "foot"))
CHAINS: Final = np.array([[[JOINT_INDEX[f"{n}_{s}"] for n in names] for s in ("right", "left")] for names in _NAMES])
"""Joints (2 kinds, 2 sides, LINKS) of the limbs: arms then legs, right then left, from the trunk outwards."""
LINKS: Final = CHAINS.shape[2]


@dataclass(frozen=True, slots=True, eq=False)
class ChainNet:
    """The network of one kind of limb. convolutions: over the crop of each joint. first: (LINKS * features +
    3 N_JOINTS, H1), first_bias: (H1,). second: (H1, H2), second_bias. last: (H2, 4 LINKS), last_bias: move in STEP_M
    and log spread of each joint."""

    convolutions: tuple[Convolution, ...]
    first: F32
    first_bias: F32
    second: F32
    second_bias: F32
    last: F32
    last_bias: F32


def pose_vectors(joints_m: Floats, kind: int) -> F32:
    """All joints from the root of each limb (2, 3 N_JOINTS), for the left limb mirrored and with the sides swapped."""
    right, left = joints_m - joints_m[CHAINS[kind, 0, 0]], joints_m - joints_m[CHAINS[kind, 1, 0]]
    left = left[list(MIRROR_JOINT)] * np.array([-1.0, 1.0, 1.0])
    return np.stack([right.reshape(-1), left.reshape(-1)]).astype(np.float32)


def limb_crops(
    flat_mm: npt.NDArray[np.int16],
    first: int,
    width: int,
    height: int,
    intrinsics: Floats,
    joints_m: Floats,
    kind: int,
) -> F32:
    """Crops (2 LINKS, rows, columns, 2) of both limbs' joints, see teleop.body.refine.joint_crops."""
    s = LOCAL
    shape = (s.rows, s.columns, s.cell_m, s.unit_m, s.near, s.far)
    which = CHAINS[kind].reshape(-1)
    left = np.repeat([False, True], LINKS)
    return joint_crops(flat_mm, first, width, height, intrinsics, joints_m[which], left, shape)


def limb_moves(net: ChainNet, crops: F32, poses: F32) -> tuple[Floats, Floats]:
    """How far the joints of N limbs are off (N, LINKS, 3) in metres, in the orientation of their crops, and the
    spread (N, LINKS) left over. crops: (N LINKS, rows, columns, 2). poses: (N, 3 N_JOINTS)."""
    values = crops
    for layer in net.convolutions:
        values = convolve(layer, values)
    hidden = np.concatenate([values.reshape(len(poses), -1), poses], axis=1) @ net.first
    rectify(hidden, net.first_bias)
    hidden = hidden @ net.second
    rectify(hidden, net.second_bias)
    out = (hidden @ net.last + net.last_bias).reshape(len(poses), LINKS, 4).astype(np.float64)
    return out[..., :3] * STEP_M, np.exp(out[..., 3]) * SPREAD_M


def straighten(
    nets: tuple[ChainNet, ChainNet],
    flat_mm: npt.NDArray[np.int16],
    width: int,
    height: int,
    intrinsics: Floats,
    joints_m: Floats,
    spread_m: Floats,
) -> tuple[Floats, Floats]:
    """Joints (20, 3) and spreads (20,) with those of all limbs placed anew."""
    joints, spreads = joints_m.copy(), spread_m.copy()
    for kind, net in enumerate(nets):
        crops = limb_crops(flat_mm, 0, width, height, intrinsics, joints_m, kind)
        move, spread = limb_moves(net, crops, pose_vectors(joints_m, kind))
        move[1, :, 0] *= -1.0
        joints[CHAINS[kind]] += move
        spreads[CHAINS[kind]] = spread
    return joints, spreads
