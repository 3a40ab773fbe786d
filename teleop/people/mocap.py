"""Poses of recorded people, brought to our rig by the directions of their limbs.

``cmu_mocap`` (38 joints, facing +z, the left side at +x) and ``kinect_skeletons`` (20 joints, sensor axes).
The turn about the vertical is taken out: everybody faces the sensor, and the sampler turns them again.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from teleop.data import data_root
from teleop.people.pose import ArmPose, LegPose, Pose
from teleop.people.rig import Floats

_CMU: Final = {
    "hips": (8, 2),
    "knees": (9, 3),
    "ankles": (10, 4),
    "toes": (11, 5),
    "neck": 16,
    "head": 18,
    "lumbar": 13,
}
_CMU |= {"shoulders": (30, 21), "elbows": (31, 22), "wrists": (32, 23)}
_SDK: Final = {
    "hips": (16, 12),
    "knees": (17, 13),
    "ankles": (18, 14),
    "toes": (19, 15),
    "neck": 2,
    "head": 3,
    "lumbar": 1,
}
_SDK |= {"shoulders": (8, 4), "elbows": (9, 5), "wrists": (10, 6)}
SPLITS: Final = ("train", "validation", "test")


@dataclass(frozen=True, slots=True, eq=False)
class PoseLibrary:
    """N poses: limbs (N, 2, 5, 3) unit directions (upper arm, forearm, thigh, shin, toes; right, left), trunk (N, 3, 3, 3)."""

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


def _library(p: Floats, index: dict[str, tuple[int, int] | int]) -> PoseLibrary:
    """Joints (N, J, 3) with x to the person's right, y up (right-handed) to limb directions facing -z."""
    right = p[:, index["hips"][0]] - p[:, index["hips"][1]] + p[:, index["shoulders"][0]] - p[:, index["shoulders"][1]]  # type: ignore[index]
    angle = np.arctan2(right[:, 2], right[:, 0])
    c, s = np.cos(angle), np.sin(angle)
    turn = np.zeros((len(p), 3, 3))
    turn[:, 0, 0], turn[:, 0, 2], turn[:, 1, 1], turn[:, 2, 0], turn[:, 2, 2] = c, s, 1.0, -s, c
    p = np.einsum("nij,nkj->nki", turn, p)

    def pair(name: str) -> Floats:
        return p[:, list(index[name])]  # type: ignore[arg-type]

    def one(name: str) -> Floats:
        return p[:, index[name]]

    hips, shoulders = pair("hips"), pair("shoulders")
    toes = pair("toes") - pair("ankles")
    toes[:, :, 1] = 0.0
    limbs = np.stack(
        [
            _unit(pair("elbows") - shoulders),
            _unit(pair("wrists") - pair("elbows")),
            _unit(pair("knees") - hips),
            _unit(pair("ankles") - pair("knees")),
            _unit(toes),
        ],
        axis=2,
    )
    spine = one("neck") - hips.mean(axis=1)
    chest = _frames(shoulders[:, 0] - shoulders[:, 1], spine)
    pelvis = _frames(hips[:, 0] - hips[:, 1], 0.5 * _unit(spine) + np.array([0.0, 0.5, 0.0]))
    head = _frames(shoulders[:, 0] - shoulders[:, 1], 0.5 * _unit(one("head") - one("neck")) + 0.5 * _unit(spine))
    upright = (_unit(spine)[:, 1] > 0.75) & np.isfinite(limbs).all(axis=(1, 2, 3))
    return PoseLibrary(limbs[upright], np.stack([pelvis, chest, head], axis=1)[upright])


def _split_of(k: int) -> str:
    return "validation" if k % 10 == 3 else "test" if k % 10 in (6, 9) else "train"


@lru_cache(maxsize=3)
def library(split: str) -> PoseLibrary | None:
    """Recorded poses of one split (whole clips and people apart), about every sixth frame; None without the data sets."""
    root, found = data_root(), []
    cmu = root and root / "cmu_mocap" / "cmu_actions_xyz_mm_60hz.npz"
    if cmu and cmu.is_file():
        with np.load(cmu) as data:
            clips = sorted(k for k in data.files if k.split("__")[0] in ("train", "test"))
            for k, clip in enumerate(clips):
                if _split_of(k) == split:
                    found.append(_library(data[clip][1::6].astype(np.float64) * np.array([-1e-3, 1e-3, -1e-3]), _CMU))
    sdk = root and root / "kinect_skeletons" / "precog.npz"
    if sdk and sdk.is_file():
        with np.load(sdk) as data:
            starts = np.concatenate([[0], np.cumsum(data["lengths"])])
            for k, (a, b) in enumerate(zip(starts[:-1], starts[1:], strict=True)):
                if _split_of(k // 6) == split:
                    rows = np.arange(a, b, 6)
                    found.append(_library(data["joints"][rows[data["valid"][rows]]].astype(np.float64), _SDK))
    found = [f for f in found if len(f)]
    if not found:
        return None
    return PoseLibrary(np.concatenate([f.limbs for f in found]), np.concatenate([f.trunk for f in found]))
