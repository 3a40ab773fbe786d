"""Poses of recorded people, brought to our rig by the directions of their limbs.

``cmu_mocap`` (38 joints, facing +z, the left side at +x) and ``kinect_skeletons`` (20 joints, sensor axes).
The turn about the vertical is taken out: everybody faces the sensor, and the sampler turns them again.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Final

import numpy as np

from teleop.data import data_folder, data_root
from teleop.people.distinct import distinct, limb_ends
from teleop.people.pose import ArmPose, LegPose, Pose
from teleop.people.rig import Floats

_LEAST_M: Final = 0.05
"""Poses of which no joint is farther apart than this are one (Shotton 2011)."""


@dataclass(frozen=True, slots=True)
class _Index:
    """Where the joints stand in a file; pairs are right, left."""

    hips: tuple[int, int]
    knees: tuple[int, int]
    ankles: tuple[int, int]
    toes: tuple[int, int]
    shoulders: tuple[int, int]
    elbows: tuple[int, int]
    wrists: tuple[int, int]
    neck: int
    head: int


_CMU: Final = _Index((8, 2), (9, 3), (10, 4), (11, 5), (30, 21), (31, 22), (32, 23), 16, 18)
_SDK: Final = _Index((16, 12), (17, 13), (18, 14), (19, 15), (8, 4), (9, 5), (10, 6), 2, 3)


@dataclass(frozen=True, slots=True, eq=False)
class PoseLibrary:
    """N poses: limbs (N, 2, 5, 3) unit directions, right then left (upper arm, forearm, thigh, shin, toes);
    trunk (N, 3, 3, 3) rotations of pelvis, chest and head."""

    limbs: Floats
    trunk: Floats

    def __len__(self) -> int:
        return len(self.limbs)

    def pose(self, i: int) -> Pose:
        """Pose number i, hands relaxed."""
        a = self.limbs[i]
        arms = [ArmPose(a[k, 0], a[k, 1]) for k in range(2)]
        legs = [LegPose(a[k, 2], a[k, 3], a[k, 4]) for k in range(2)]
        pelvis, chest, head = self.trunk[i]
        return Pose((arms[0], arms[1]), (legs[0], legs[1]), pelvis, chest, head)


def _unit(v: Floats) -> Floats:
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-9)


def _frames(right: Floats, up: Floats) -> Floats:
    """Rotations (N, 3, 3) with columns right, up, back; up decides."""
    y = _unit(up)
    x = _unit(right - (right * y).sum(-1, keepdims=True) * y)
    return np.stack([x, y, np.cross(x, y)], axis=-1)


def _library(p: Floats, index: _Index) -> PoseLibrary:
    """Joints (N, J, 3) with x to the person's right, y up (right-handed) to limb directions facing -z."""
    right = p[:, index.hips[0]] - p[:, index.hips[1]] + p[:, index.shoulders[0]] - p[:, index.shoulders[1]]
    angle = np.arctan2(right[:, 2], right[:, 0])
    c, s = np.cos(angle), np.sin(angle)
    turn = np.zeros((len(p), 3, 3))
    turn[:, 0, 0], turn[:, 0, 2], turn[:, 1, 1], turn[:, 2, 0], turn[:, 2, 2] = c, s, 1.0, -s, c
    p = np.einsum("nij,nkj->nki", turn, p)

    def pair(ij: tuple[int, int]) -> Floats:
        return p[:, ij, :]

    hips, shoulders, elbows = pair(index.hips), pair(index.shoulders), pair(index.elbows)
    knees, ankles = pair(index.knees), pair(index.ankles)
    toes = pair(index.toes) - ankles
    toes[:, :, 1] = 0.0
    limbs = np.stack(
        [
            _unit(elbows - shoulders),
            _unit(pair(index.wrists) - elbows),
            _unit(knees - hips),
            _unit(ankles - knees),
            _unit(toes),
        ],
        axis=2,
    )
    spine = p[:, index.neck] - hips.mean(axis=1)
    chest = _frames(shoulders[:, 0] - shoulders[:, 1], spine)
    pelvis = _frames(hips[:, 0] - hips[:, 1], 0.5 * _unit(spine) + np.array([0.0, 0.5, 0.0]))
    head = _frames(
        shoulders[:, 0] - shoulders[:, 1], 0.5 * _unit(p[:, index.head] - p[:, index.neck]) + 0.5 * _unit(spine)
    )
    upright = (_unit(spine)[:, 1] > 0.75) & np.isfinite(limbs).all(axis=(1, 2, 3))
    return PoseLibrary(limbs[upright], np.stack([pelvis, chest, head], axis=1)[upright])


def _split_of(k: int) -> str:
    return "validation" if k % 10 == 3 else "test" if k % 10 in (6, 9) else "train"


@lru_cache(maxsize=3)
def library(split: str) -> PoseLibrary | None:
    """Recorded poses of one split (whole clips apart), no two alike; None without the data sets."""
    root, found = data_root(), []
    cmu = root and root / "cmu_mocap" / "cmu_actions_xyz_mm_60hz.npz"
    if cmu and cmu.is_file():
        with np.load(cmu) as data:
            clips = sorted(k for k in data.files if k.split("__")[0] in ("train", "test"))
            for k, clip in enumerate(clips):
                if _split_of(k) == split:
                    found.append(_library(data[clip][1::2].astype(np.float64) * np.array([-1e-3, 1e-3, -1e-3]), _CMU))
    sdk = root and root / "kinect_skeletons" / "precog.npz"
    if sdk and sdk.is_file():
        with np.load(sdk) as data:
            starts = np.concatenate([[0], np.cumsum(data["lengths"])])
            for k, (a, b) in enumerate(pairwise(starts)):
                if _split_of(k // 6) == split:
                    rows = np.arange(a, b, 2)
                    found.append(_library(data["joints"][rows[data["valid"][rows]]].astype(np.float64), _SDK))
    found = [f for f in found if len(f)]
    if not found:
        return None
    limbs, trunk = np.concatenate([f.limbs for f in found]), np.concatenate([f.trunk for f in found])
    kept = distinct(limb_ends(limbs), _LEAST_M)
    return PoseLibrary(limbs[kept], trunk[kept])


@lru_cache(maxsize=1)
def standing_clips() -> tuple[PoseLibrary, ...]:
    """Whole clips at 60 Hz of people who stand and work with their arms: signals, traffic, a window.

    Raises DataError without the data set.
    """
    path = data_folder("cmu_mocap") / "cmu_actions_xyz_mm_60hz.npz"
    words = ("basketball_signal", "directing_traffic", "washwindow")
    with np.load(path) as data:
        names = sorted(name for name in data.files if any(word in name for word in words))
        return tuple(_library(data[n].astype(np.float64) * np.array([-1e-3, 1e-3, -1e-3]), _CMU) for n in names)
