"""From the operator's depth image to the joints of one frame: the networks, and how sure they are.

The coarse network places every joint from the whole operator, then arms, legs and trunk are looked at closely, twice.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.body.coarse import CoarseNet, locate
from teleop.body.features import Pixels
from teleop.body.limbs import GROUPS, Round, place

N_CUES: Final = 6
_ALL: Final = tuple(range(len(GROUPS)))
_ARMS: Final = (0,)
_REST: Final = (1, 2)

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Cascade:
    """coarse: the network of the whole operator. rounds: looks at the limbs. trust: (N_CUES + 1,) weights of a
    logistic regression, see trust_cues."""

    coarse: CoarseNet
    rounds: tuple[Round, ...]
    trust: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """joints_m: (20, 3), none unknown. spread_m: (20,). cues: (20, N_CUES) of how well each is known, see
    trust_cues."""

    joints_m: Floats
    spread_m: Floats
    cues: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Begun:
    """The coarse joints (20, 3) and spreads (20,), and those after the looks so far."""

    coarse_m: Floats
    coarse_spread_m: Floats
    joints_m: Floats
    spread_m: Floats
    looks: int


def begin(cascade: Cascade, image: Pixels, rounds: int) -> Begun:
    """The coarse network and the first look, which take as long as the forest does beside them."""
    joints_m, spread_m = coarse_m, coarse_spread_m = locate(cascade.coarse, image)
    first = cascade.rounds[: min(rounds, 1)]
    for nets in first:
        joints_m, spread_m = place(nets, image, joints_m, _ALL)
    return Begun(coarse_m, coarse_spread_m, joints_m, spread_m, len(first))


def settle(
    cascade: Cascade, image: Pixels, begun: Begun, forest_m: Floats, rounds: int, beside: Executor | None = None
) -> Placed:
    """From the first look (begin) on, through at most ``rounds`` looks.

    forest_m: (20, 3) the forest's joints, NaN unknown: joints that both find are surer. beside: where the arms are
    looked at while legs and trunk are looked at here.
    """
    joints_m, spread_m = begun.joints_m, begun.spread_m
    for nets in cascade.rounds[begun.looks : rounds]:
        joints_m, spread_m = _both(partial(place, nets, image, joints_m), beside)
    moved_m = np.linalg.norm(joints_m - begun.coarse_m, axis=1)
    apart_m = np.linalg.norm(forest_m - joints_m, axis=1)
    return Placed(joints_m, spread_m, trust_cues(begun.coarse_spread_m, spread_m, moved_m, apart_m))


def _both(look: Callable[[tuple[int, ...]], tuple[Floats, Floats]], beside: Executor | None) -> tuple[Floats, Floats]:
    """Arms beside, legs and trunk here; joints and spreads of all groups."""
    if beside is None:
        return look(_ALL)
    arms = beside.submit(look, _ARMS)
    joints, spread = look(_REST)
    arm_joints, arm_spread = arms.result()
    which = GROUPS[_ARMS[0]]
    joints[which], spread[which] = arm_joints[which], arm_spread[which]
    return joints, spread


def trust_cues(coarse_spread_m: Floats, spread_m: Floats, moved_m: Floats, apart_m: Floats) -> Floats:
    """What tells how well a joint is known (20, N_CUES): logarithms of the coarse and the last spread, of how far the
    looks moved the joint and it is from the forest's (0.3 m where the forest knows nothing), and two squares."""
    apart = np.log(0.02 + np.minimum(np.nan_to_num(apart_m, nan=0.3), 0.5))
    coarse, fine = np.log(coarse_spread_m / 0.05), np.log(spread_m / 0.02)
    return np.stack([coarse, fine, np.log(0.01 + moved_m), apart, coarse**2, fine**2], axis=1)


def trust(cues: Floats, weights: Floats) -> Floats:
    """Confidence (20,): the probability that a joint is within 10 cm of the true one."""
    return np.asarray(1.0 / (1.0 + np.exp(-np.clip(cues @ weights[:-1] + weights[-1], -30.0, 30.0))))
