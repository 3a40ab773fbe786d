"""From the operator's depth image to the joints of one frame: the networks, and how sure they are.

The coarse network places every joint from the whole operator, then arms, legs and trunk are looked at closely, twice.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Final, TypeVar, TypeVarTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.coarse import CoarseNet, locate
from teleop.body.features import Pixels
from teleop.body.limbs import GROUPS, Round, place

N_CUES: Final = 6
_AHEAD: Final = (0, 2), (1,)
"""Groups of the first look that are looked at beside, before the forest is done, and those left for then."""
_BESIDE: Final = (0,), (1, 2)
"""The same of the other looks, which begin at once on both sides."""

Floats = npt.NDArray[np.float64]
Known = tuple[Floats, Floats]
"""Joints (20, 3) and how far they may be off (20,), in metres."""
T = TypeVarTuple("T")
R = TypeVar("R")


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
class Whole:
    """What the coarse network found: joints_m (20, 3), spread_m (20,). expected_m: (20, 3) the joints as the last
    frames let expect them, where it agrees with all of them; else None."""

    joints_m: Floats
    spread_m: Floats
    expected_m: Floats | None


@dataclass(frozen=True, slots=True, eq=False)
class Begun:
    """What is under way: the coarse network and a part of the first look, None where there is none."""

    whole: Callable[[], Whole]
    ahead: Callable[[], Known | None]


def begin(
    cascade: Cascade,
    image: Pixels,
    rounds: int,
    expected_m: Floats | None = None,
    agree_m: float = 0.0,
    beside: ThreadPoolExecutor | None = None,
) -> Begun:
    """Start the coarse network and most of the first look, which take as long as the forest does beside them.

    expected_m: (20, 3) joints by the last frames, None without; where none of the coarse network's is agree_m or more
    away, they take the place of the first look's. beside: one thread, first in, first out: the look waits for the
    network. What a job raises is raised by settle.
    """
    whole = _later(beside, _whole, cascade, image, expected_m if len(cascade.rounds[:rounds]) > 1 else None, agree_m)

    def look() -> Known | None:
        seen = whole()
        if seen.expected_m is not None or not cascade.rounds[:rounds]:
            return None
        return place(cascade.rounds[0], image, seen.joints_m, _AHEAD[0])

    return Begun(whole, _later(beside, look))


def _whole(cascade: Cascade, image: Pixels, expected_m: Floats | None, agree_m: float) -> Whole:
    joints_m, spread_m = locate(cascade.coarse, image)
    if expected_m is not None and not (np.linalg.norm(expected_m - joints_m, axis=1) < agree_m).all():
        expected_m = None
    return Whole(joints_m, spread_m, expected_m)


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
    whole = begun.whole()
    joints_m, spread_m, looks = whole.joints_m, whole.spread_m, cascade.rounds[:rounds]
    if whole.expected_m is not None:
        joints_m, looks = whole.expected_m, looks[1:]
    elif looks:
        here, ahead = place(looks[0], image, joints_m, _AHEAD[1]), begun.ahead()
        assert ahead is not None
        (joints_m, spread_m), looks = _joined(here, ahead, _AHEAD[0]), looks[1:]
    for nets in looks:
        there = _later(beside, place, nets, image, joints_m, _BESIDE[0])
        joints_m, spread_m = _joined(place(nets, image, joints_m, _BESIDE[1]), there(), _BESIDE[0])
    cues = _cues(whole.joints_m, whole.spread_m, joints_m, spread_m, forest_m)
    return Placed(joints_m, spread_m, cues)


def _later(beside: ThreadPoolExecutor | None, work: Callable[[*T], R], *args: *T) -> Callable[[], R]:
    """The work's result once it is asked for; done at once where there is nobody beside."""
    if beside is None:
        known = work(*args)
        return lambda: known
    return beside.submit(work, *args).result


def _joined(here: Known, there: Known, groups: tuple[int, ...]) -> Known:
    """Joints and spreads, those of some groups from there."""
    for group in groups:
        for of, own in zip(here, there, strict=True):
            of[GROUPS[group]] = own[GROUPS[group]]
    return here


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
