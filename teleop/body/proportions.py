"""Arms as long as the rest of the body says.

A forearm that points at the sensor hides the elbow behind the hand; where the networks then place it, one bone is far
too short. Trunk and legs tell how large the body is, and so how long its arms are: the joints of an arm that is out of
proportion give way as those of an operator's own bones do (teleop.body.bones), each by the variance it was found with.
"""

from __future__ import annotations

from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.bones import PAIRS, relax
from teleop.config.body import ProportionsConfig
from teleop.joints import BONES, JOINT_INDEX

Floats = npt.NDArray[np.float64]


def _bones(*names: str) -> npt.NDArray[np.int64]:
    """Numbers in BONES of those between two named joints."""
    ends = {tuple(sorted((a, b))): n for n, (a, b) in enumerate(BONES)}
    pairs = (sorted(JOINT_INDEX[end] for end in name.split()) for name in names)
    return np.array([ends[(a, b)] for a, b in pairs])


_FRAME: Final = _bones(
    "shoulder_center spine",
    "spine hip_center",
    *(f"hip_{side} knee_{side}" for side in ("right", "left")),
    *(f"knee_{side} ankle_{side}" for side in ("right", "left")),
)
"""Bones that tell the size of a body, nearly always seen well."""
_FRAME_ENDS: Final = np.array(BONES)[_FRAME]
_ARM: Final = _bones("shoulder_right elbow_right", "elbow_right wrist_right")
_PAIRS: Final = np.ascontiguousarray(PAIRS[: len(_ARM)])
_SWEEPS: Final = 8
NOBODYS_M: Final = np.full(len(_ARM), np.nan)
"""Lengths of an arm of whom nothing is known."""


@nb.njit(cache=True, nogil=True)
def _correct(
    joints_m: Floats, variance: Floats, pairs: npt.NDArray[np.int64], length_m: Floats, own: Floats, off: float
) -> None:
    """Relax the arms of which a bone is out of proportion. pairs: (bones, sides, 2) of an arm."""
    for side in range(pairs.shape[1]):
        wrong = False
        for bone in range(len(pairs)):
            a, b = pairs[bone, side]
            square = 0.0
            for k in range(3):
                square += (joints_m[b, k] - joints_m[a, k]) ** 2
            wrong |= abs(np.sqrt(square) / length_m[bone] - 1.0) > off  # False where one is unknown
        if wrong:
            relax(joints_m, variance, np.ascontiguousarray(pairs[:, side : side + 1]), length_m, own, _SWEEPS)


@nb.njit(cache=True, nogil=True)
def _size(
    joints_m: Floats, spread_m: Floats, ends: npt.NDArray[np.int64], bones_m: Floats, sure_m: float
) -> tuple[float, int]:
    """Length of the surely found bones over their mean, and their number."""
    found_m, mean_m, count = 0.0, 0.0, 0
    for bone in range(len(ends)):
        a, b = ends[bone]
        square = 0.0
        for k in range(3):
            square += (joints_m[a, k] - joints_m[b, k]) ** 2
        if max(spread_m[a], spread_m[b]) <= sure_m and not np.isnan(square):
            found_m, mean_m, count = found_m + np.sqrt(square), mean_m + bones_m[bone], count + 1
    return found_m / max(mean_m, 1e-9), count


def size_of(joints_m: Floats, spread_m: Floats, bones_m: Floats, sure_m: float) -> float | None:
    """How large the body is, 1 the mean of training's people; None where too little of it is found surely."""
    size, count = _size(joints_m, spread_m, _FRAME_ENDS, bones_m[_FRAME], sure_m)
    return float(size) if 2 * count >= len(_FRAME) else None


def in_proportion(
    joints_m: Floats, spread_m: Floats, bones_m: Floats, own_m: Floats, config: ProportionsConfig
) -> Floats:
    """The joints (20, 3) with arms in proportion; NaN stays.

    spread_m: (20,), of the networks. bones_m: (B,) mean lengths of training's people, see teleop.joints.BONES. own_m:
    (2,) lengths of the operator's own upper arm and forearm, NaN unknown.
    """
    size = size_of(joints_m, spread_m, bones_m, config.sure_m) if config.enabled else None
    if size is None:
        return joints_m
    length_m, out = np.where(np.isnan(own_m), size * bones_m[_ARM], own_m), joints_m.copy()
    _correct(out, spread_m**2, _PAIRS, length_m, (config.tolerance * length_m) ** 2, config.off)
    return out
