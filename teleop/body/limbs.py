"""Arms, legs and trunk as wholes: what is seen round all joints of a limb tells best where each of them is.

The stages after the coarse network (pose-indexed crops, after Sun et al., CVPR 2015): one network looks at both arms,
one at both legs, one at the trunk; left limbs are mirrored. A second round looks at the arms again from where the first
one ended.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.crop import LOCAL, Shape, joint_crops
from teleop.body.features import Pixels, PixelTuple
from teleop.body.layers import F32, I16, Stack, in_steps, run_dense, run_stack
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
SWAPPED: Final = np.array(MIRROR_JOINT)


@dataclass(frozen=True, slots=True)
class Part:
    """Limbs of one group that are placed in one go. group: index in GROUPS. first, end: sides, the right is 0."""

    group: int
    first: int = 0
    end: int = 2

    @property
    def joints(self) -> npt.NDArray[np.int64]:
        """(sides, LINKS)."""
        return GROUPS[self.group][self.first : self.end]


ARMS: Final = Part(0)
RIGHT_ARM: Final = Part(0, 0, 1)
LEFT_ARM: Final = Part(0, 1, 2)
LEGS: Final = Part(1)
TRUNK: Final = Part(2)


NetTuple = tuple[
    tuple[tuple[F32, ...], tuple[F32, ...], npt.NDArray[np.int64]], tuple[I16, F32], F32, F32, tuple[F32, F32, F32]
]
"""A LimbNet as compiled code takes it: stack, the three layers, their biases."""


@dataclass(frozen=True, slots=True, eq=False)
class LimbNet:
    """The network of one group. stack: over the crop of each joint. first: (LINKS * features + 3 N_JOINTS, H1),
    first_bias: (H1,). second: (H1, H2), second_bias. last: (H2, 4 LINKS), last_bias: move in STEP_M and log spread of
    each joint. first_in_steps: first as it is run."""

    stack: Stack
    first: F32
    first_bias: F32
    second: F32
    second_bias: F32
    last: F32
    last_bias: F32
    first_in_steps: tuple[I16, F32] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "first_in_steps", in_steps(self.first))

    def tuple(self) -> NetTuple:
        """For compiled code."""
        biases = (self.first_bias, self.second_bias, self.last_bias)
        return self.stack.parts(), self.first_in_steps, self.second, self.last, biases


Round = tuple[LimbNet, ...]
"""One look: networks of the first groups in the order of GROUPS; the joints of the others stay."""


@nb.njit(cache=True, nogil=True)
def pose_vectors(joints_m: Floats, group: npt.NDArray[np.int64], turned: bool, swapped: npt.NDArray[np.int64]) -> F32:
    """All joints from the root of each limb (sides, 3 N_JOINTS), for a left limb mirrored with the sides swapped.

    turned: the other way round, or the first is a left one. swapped: (20,) each joint's mirror image.
    """
    count = len(joints_m)
    out = np.empty((len(group), 3 * count), np.float32)
    for side in range(len(group)):
        root = joints_m[group[side, 0]]
        mirror = (side == 1) != turned
        for j in range(count):
            of = joints_m[swapped[j]] if mirror else joints_m[j]
            out[side, 3 * j] = root[0] - of[0] if mirror else of[0] - root[0]
            out[side, 3 * j + 1] = of[1] - root[1]
            out[side, 3 * j + 2] = of[2] - root[2]
    return out


@nb.njit(cache=True, nogil=True)
def limb_crops(image: PixelTuple, joints_m: Floats, group: npt.NDArray[np.int64], turned: bool, shape: Shape) -> F32:
    """Crops (sides * LINKS, rows, columns, 2) of a group's joints (sides, LINKS); see teleop.body.crop.joint_crops.

    turned: those that are not mirrored are, in training, or where the first is a left one.
    """
    sides, links = group.shape
    at, mirror = np.empty((sides * links, 3)), np.empty(sides * links, np.bool_)
    for side in range(sides):
        for link in range(links):
            at[side * links + link] = joints_m[group[side, link]]
            mirror[side * links + link] = (side == 1) != turned
    return joint_crops(image, at, mirror, shape)


@nb.njit(cache=True, nogil=True)
def run_limbs(crops: F32, poses: F32, net: NetTuple) -> F32:
    """The network's outputs (N, 4 LINKS) for N limbs: crops (N LINKS, rows, columns, 2), poses (N, 3 N_JOINTS)."""
    (kernels, biases, shape), first, second, last, dense_biases = net
    seen = run_stack(crops, kernels, biases, shape)
    limbs, own = len(poses), poses.shape[1]
    features = seen.reshape(limbs, -1)
    wide = features.shape[1]
    values = np.empty((limbs, wide + own), np.float32)
    values[:, :wide] = features
    values[:, wide:] = poses
    return run_dense(values, first, second, last, dense_biases)


@nb.njit(cache=True, nogil=True)
def _place_group(
    image: PixelTuple,
    joints_m: Floats,
    group: npt.NDArray[np.int64],
    left: bool,
    swapped: npt.NDArray[np.int64],
    crop: Shape,
    net: NetTuple,
    placed_m: Floats,
    spread_m: Floats,
) -> None:
    """left: the first limb is a left one."""
    crops = limb_crops(image, joints_m, group, left, crop)
    poses = pose_vectors(joints_m, group, left, swapped)
    out = run_limbs(crops, poses, net)
    for side in range(len(group)):
        for link in range(group.shape[1]):
            j = group[side, link]
            for a in range(3):
                move = np.float64(out[side, 4 * link + a]) * STEP_M
                placed_m[j, a] = joints_m[j, a] + (-move if (side == 1) != left and a == 0 else move)
            spread_m[j] = np.exp(np.float64(out[side, 4 * link + 3])) * SPREAD_M


def before_sensor(joints_m: Floats) -> Floats:
    """The joints, none of them nearer than NEAREST_M."""
    out = joints_m.copy()
    out[:, 2] = np.maximum(out[:, 2], NEAREST_M)
    return out


def place(nets: Round, image: Pixels, joints_m: Floats, parts: tuple[Part, ...]) -> tuple[Floats, Floats]:
    """Joints (20, 3) and spreads (20,) with those of some parts placed anew; the other spreads are NaN."""
    before = before_sensor(joints_m)
    placed, spread = joints_m.copy(), np.full(N_JOINTS, np.nan)
    for part in parts:
        net, left = nets[part.group].tuple(), part.first == 1
        _place_group(image.tuple(), before, part.joints, left, SWAPPED, LOCAL.tuple(), net, placed, spread)
    return placed, spread
