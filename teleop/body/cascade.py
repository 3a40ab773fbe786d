"""From the operator's depth image to the joints of one frame: the networks, and how sure they are.

The coarse network places every joint from the whole operator, then arms, legs and trunk are looked at closely, the arms
twice.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.beside import later
from teleop.body.coarse import CoarseNet, locate
from teleop.body.features import Pixels
from teleop.body.limbs import ARMS, LEFT_ARM, LEGS, RIGHT_ARM, TRUNK, Part, Round, place

N_CUES: Final = 6
_AHEAD: Final = (ARMS, TRUNK), (LEGS,)
"""Parts of the first look that are looked at beside, before the forest is done, and those left for then."""
_ARMS_AGAIN: Final = (LEFT_ARM,), (RIGHT_ARM,)
"""The same of another look, which begins at once on both sides: at the arms alone."""
_ALL_AGAIN: Final = (ARMS,), (LEGS, TRUNK)
Floats = npt.NDArray[np.float64]
Known = tuple[Floats, Floats]
"""Joints (20, 3) and how far they may be off (20,), in metres."""


@dataclass(frozen=True, slots=True, eq=False)
class Cascade:
    """coarse: the network of the whole operator. rounds: looks at the limbs. trust: (N_CUES + 1,) weights of a
    logistic regression, see _cues."""

    coarse: CoarseNet
    rounds: tuple[Round, ...]
    trust: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """joints_m: (20, 3), none unknown. spread_m: (20,). cues: (20, N_CUES) of how well each is known, see
    _cues."""

    joints_m: Floats
    spread_m: Floats
    cues: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Begun:
    """What is under way: all joints (20, 3) and spreads (20,) of the coarse network, and a part of the first look."""

    whole: Callable[[], Known]
    ahead: Callable[[], Known] | None


def begin(cascade: Cascade, image: Pixels, rounds: int, beside: ThreadPoolExecutor | None = None) -> Begun:
    """Start the coarse network and most of the first look, which take as long as the forest does beside them.

    beside: one thread, first in, first out: the look waits for the network. What a job raises there, settle raises.
    """
    whole = later(beside, locate, cascade.coarse, image)
    if not cascade.rounds[:rounds]:
        return Begun(whole, None)
    return Begun(whole, later(beside, lambda: place(cascade.rounds[0], image, whole()[0], _AHEAD[0])))


def settle(
    cascade: Cascade,
    image: Pixels,
    begun: Begun,
    forest_m: Floats,
    rounds: int,
    beside: ThreadPoolExecutor | None = None,
) -> Placed:
    """From what is under way (begin) on, through at most ``rounds`` looks.

    forest_m: (20, 3) the forest's joints, NaN unknown: joints that both find are surer. beside: where some limbs are
    looked at while the others are looked at here.
    """
    known = coarse = begun.whole()
    ahead = begun.ahead
    for nets in cascade.rounds[:rounds]:
        there, here = _AHEAD if ahead is not None else _ARMS_AGAIN if len(nets) == 1 else _ALL_AGAIN
        theirs = ahead or later(beside, place, nets, image, known[0], there)
        ours = place(nets, image, known[0], here)
        known = _with(_with(known, ours, here), theirs(), there)
        ahead = None
    joints_m, spread_m = known
    return Placed(joints_m, spread_m, _cues(*coarse, joints_m, spread_m, forest_m))


def _with(known: Known, placed: Known, parts: tuple[Part, ...]) -> Known:
    """What is known, some parts of it as they were placed."""
    joints_m, spread_m = known[0].copy(), known[1].copy()
    for part in parts:
        of = part.joints
        joints_m[of], spread_m[of] = placed[0][of], placed[1][of]
    return joints_m, spread_m


@nb.njit(cache=True, nogil=True)
def _cues(coarse_m: Floats, coarse_spread_m: Floats, joints_m: Floats, spread_m: Floats, forest_m: Floats) -> Floats:
    """What tells how well a joint is known (20, N_CUES): logarithms of the coarse and the last spread, of how far the
    looks moved the joint and it is from the forest's (0.3 m where the forest knows nothing), and two squares."""
    out = np.empty((len(joints_m), N_CUES))
    for j in range(len(joints_m)):
        moved, apart = 0.0, 0.0
        for k in range(3):
            moved += (joints_m[j, k] - coarse_m[j, k]) ** 2
            apart += (joints_m[j, k] - forest_m[j, k]) ** 2
        apart_m = 0.3 if np.isnan(apart) else min(np.sqrt(apart), 0.5)
        coarse, fine = np.log(coarse_spread_m[j] / 0.05), np.log(spread_m[j] / 0.02)
        out[j, 0], out[j, 1], out[j, 2] = coarse, fine, np.log(0.01 + np.sqrt(moved))
        out[j, 3], out[j, 4], out[j, 5] = np.log(0.02 + apart_m), coarse**2, fine**2
    return out


def trust(cues: Floats, weights: Floats) -> Floats:
    """Confidence (20,): the probability that a joint is within 10 cm of the true one."""
    return np.asarray(1.0 / (1.0 + np.exp(-np.clip(cues @ weights[:-1] + weights[-1], -30.0, 30.0))))
