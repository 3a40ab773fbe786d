"""Arms, legs and trunk as wholes: what is seen round all joints of a limb tells best where each of them is.

The stages after the coarse network (pose-indexed crops, after Sun et al., CVPR 2015): one network looks at both arms,
one at both legs, one at the trunk; left limbs are mirrored. A second round looks again from where the first one ended.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.body.crop import LOCAL, joint_crops
from teleop.body.features import Pixels
from teleop.body.layers import F32, Convolution, convolve, rectify
from teleop.joints import JOINT_INDEX, MIRROR_JOINT, N_JOINTS

STEP_M: Final = 0.1
"""Metres that an output of 1 moves a joint."""
SPREAD_M: Final = 0.02
"""Metres of a log spread of 0."""
NEAREST_M: Final = 0.3
"""Nothing is nearer to the sensor: a joint found there is put here before it is looked at."""
LINKS: Final = 4

Floats = npt.NDArray[np.float64]


def _pairs(*names: str) -> npt.NDArray[np.int64]:
    return np.array([[JOINT_INDEX[f"{name}_{side}"] for name in names] for side in ("right", "left")])


GROUP_NAMES: Final = ("arms", "legs", "trunk")
GROUPS: Final = (
    _pairs("shoulder", "elbow", "wrist", "hand"),
    _pairs("hip", "knee", "ankle", "foot"),
    np.array([[JOINT_INDEX[name] for name in ("shoulder_center", "head", "spine", "hip_center")]]),
)
"""Joints (sides, LINKS) of each group: right then left, from the root outwards; together all joints."""
_MIRROR: Final = np.array(MIRROR_JOINT)


@dataclass(frozen=True, slots=True, eq=False)
class LimbNet:
    """The network of one group. convolutions: over the crop of each joint. first: (LINKS * features + 3 N_JOINTS, H1),
    first_bias: (H1,). second: (H1, H2), second_bias. last: (H2, 4 LINKS), last_bias: move in STEP_M and log spread of
    each joint."""

    convolutions: tuple[Convolution, ...]
    first: F32
    first_bias: F32
    second: F32
    second_bias: F32
    last: F32
    last_bias: F32


Round = tuple[LimbNet, LimbNet, LimbNet]
"""One look at all groups, in the order of GROUPS."""


def pose_vectors(joints_m: Floats, group: int) -> F32:
    """All joints from the root of each limb (sides, 3 N_JOINTS), for a left limb mirrored with the sides swapped."""
    out = []
    for side, joints in enumerate(GROUPS[group]):
        vectors = joints_m - joints_m[joints[0]]
        if side == 1:
            vectors = vectors[_MIRROR] * np.array([-1.0, 1.0, 1.0])
        out.append(vectors.reshape(-1))
    return np.stack(out).astype(np.float32)


def limb_crops(image: Pixels, joints_m: Floats, group: int, turned: bool = False) -> F32:
    """Crops (sides * LINKS, rows, columns, 2) of a group's joints. turned: all of them are mirrored, in training."""
    joints = GROUPS[group]
    left = np.repeat(np.arange(len(joints)) == 1, LINKS) ^ turned
    at = joints_m[joints.reshape(-1)]
    return joint_crops(image.flat_mm, image.first, image.width, image.height, image.intrinsics, at, left, LOCAL.tuple())


def limb_moves(net: LimbNet, crops: F32, poses: F32) -> tuple[Floats, Floats]:
    """How far the joints of N limbs are off (N, LINKS, 3) in metres, in the orientation of their crops, and the spread
    (N, LINKS) left over. crops: (N LINKS, rows, columns, 2). poses: (N, 3 N_JOINTS)."""
    values = crops
    for layer in net.convolutions:
        values = convolve(layer, values)
    hidden = np.concatenate([values.reshape(len(poses), -1), poses], axis=1) @ net.first
    rectify(hidden, net.first_bias)
    hidden = hidden @ net.second
    rectify(hidden, net.second_bias)
    out = (hidden @ net.last + net.last_bias).reshape(len(poses), LINKS, 4).astype(np.float64)
    return out[..., :3] * STEP_M, np.exp(out[..., 3]) * SPREAD_M


def before_sensor(joints_m: Floats) -> Floats:
    """The joints, none of them nearer than NEAREST_M."""
    out = joints_m.copy()
    out[:, 2] = np.maximum(out[:, 2], NEAREST_M)
    return out


def place_group(net: LimbNet, image: Pixels, joints_m: Floats, group: int) -> tuple[Floats, Floats]:
    """Joints (sides, LINKS, 3) of one group placed anew, and their spread (sides, LINKS) in metres.

    joints_m: (20, 3) of the stage before, see before_sensor.
    """
    move, spread = limb_moves(net, limb_crops(image, joints_m, group), pose_vectors(joints_m, group))
    if len(move) == 2:
        move[1, :, 0] *= -1.0
    return joints_m[GROUPS[group]] + move, spread


def place(nets: Round, image: Pixels, joints_m: Floats, groups: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Joints (20, 3) and spreads (20,) with those of the named groups placed anew; the other spreads are NaN."""
    before = before_sensor(joints_m)
    joints, spreads = joints_m.copy(), np.full(N_JOINTS, np.nan)
    for group in groups:
        joints[GROUPS[group]], spreads[GROUPS[group]] = place_group(nets[group], image, before, group)
    return joints, spreads
