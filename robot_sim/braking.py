"""Whether the arms can still come to rest without coming too near, from where they are and how fast they move.

The arms are followed on their way to rest, pose by pose. The limiter asks at every physics tick, and most answers are
cheap: no point of an arm travels further than its joints turn times how far it is from them, so that a pose with wide
margins answers for those after it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from robot_sim.arm_angles import ARM_AXES
from robot_sim.capsules import ArmModel, arm_model
from robot_sim.clearance import least_margins_m, pose_margins, workspace
from robot_sim.commands import ARM_NAMES
from robot_sim.config import RobotConfig
from robot_sim.derived import derived

F64 = npt.NDArray[np.float64]
_T, _M, _V = "float64[:,:,:,::1]", "float64[:,:,::1]", "float64[::1]"
_MODEL = f"{_T}, {_M}, int64[::1], {_M}, {_V}, float64[:,::1], {_V}"

_LOOKS = 7
"""Poses looked at while braking, which takes 0.2 s at the most: under 35 ms apart."""


@njit(f"float64({_V}, {_V}, float64, int64)", cache=True, nogil=True)
def _turned(v, rate, time, j):  # type: ignore[no-untyped-def]
    """How far joint j turns within ``time`` of braking, signed."""
    own = min(time, abs(v[j]) / rate[j])
    return v[j] * own - 0.5 * np.sign(v[j]) * rate[j] * own * own


@njit(f"void({_MODEL}, {_V}, {_V}, {_V}, float64, {_V})", cache=True, nogil=True)
def _look(T_joint, axis, body, ends, radius, tip, limits, q, v, rate, time, margin):  # type: ignore[no-untyped-def]
    """Margins (9,) after ``time`` of braking from q at speeds v."""
    pose = q.copy()
    for j in range(len(q)):
        pose[j] = q[j] + _turned(v, rate, time, j)
    margin[:] = pose_margins(T_joint, axis, body, ends, radius, tip, limits, pose)


@njit(f"float64({_V}, {_V})", cache=True, nogil=True)
def _longest(v, rate):  # type: ignore[no-untyped-def]
    """How long the last joint takes to come to rest."""
    longest = 0.0
    for j in range(len(v)):
        longest = max(longest, abs(v[j]) / rate[j])
    return longest


@njit(f"{_V}({_MODEL}, {_V}, {_V}, {_V}, int64)", cache=True, nogil=True)
def _followed(T_joint, axis, body, ends, radius, tip, limits, q, v, rate, looks):  # type: ignore[no-untyped-def]
    """Smallest margins (9,) from q, moving at v, until every joint has braked at its rate: ``looks`` even times."""
    longest = _longest(v, rate)
    least, margin = np.full(9, np.inf), np.empty(9)
    for look in range(looks if longest > 0.0 else 1):
        time = longest * look / max(looks - 1, 1)
        _look(T_joint, axis, body, ends, radius, tip, limits, q, v, rate, time, margin)
        least = np.minimum(least, margin)
    return least


@njit(f"boolean({_MODEL}, float64[:,::1], {_V}, {_V}, {_V}, {_V}, int64)", cache=True, nogil=True)
def _keeps(T_joint, axis, body, ends, radius, tip, limits, lever, q, v, rate, least, looks):  # type: ignore[no-untyped-def]
    """Whether all margins stay at least ``least`` (9,) at those times; leaves out looks that cannot matter."""
    longest = _longest(v, rate)
    margin, travel = np.empty(9), np.empty(3)
    look = 0
    while look < looks:
        time = longest * look / max(looks - 1, 1)
        _look(T_joint, axis, body, ends, radius, tip, limits, q, v, rate, time, margin)
        if (margin < least).any():
            return False
        look += 1
        while look < looks:  # the next looks that lie nearer than the margins of this one are wide
            later = longest * look / max(looks - 1, 1)
            travel[:] = 0.0
            for j in range(len(q)):
                turned = abs(_turned(v, rate, later, j) - _turned(v, rate, time, j))
                travel[j // 3] += turned * lever[j // 3, j % 3]
            spare = margin - least
            near = min(spare[0] - travel[0] - travel[1], spare[1] - travel[0] - travel[2])
            near = min(near, spare[2] - travel[1] - travel[2])
            for arm in range(3):
                near = min(near, min(spare[3 + arm], spare[6 + arm]) - travel[arm])
            if near < 0.0:
                break
            look += 1
    return True


@dataclass(frozen=True, slots=True, eq=False)
class _Guard:
    """What the kernels take, in their order, and what has to be kept."""

    model: tuple[F64, F64, npt.NDArray[np.int64], F64, F64, F64, F64]
    lever_m: F64
    rate: F64
    least_m: F64


@derived
def _guard(config: RobotConfig) -> _Guard:
    m: ArmModel = arm_model(config)
    # accelerations (9,) [rad/s2] of the arms' joints
    rate = np.tile([getattr(config.arm, axis).acceleration for axis in ARM_AXES], len(ARM_NAMES))
    model = (m.T_joint, m.axis, m.body, m.ends_m, m.radius_m, m.tip_m, workspace(config))
    return _Guard(model, m.lever_m, rate, least_margins_m(config))


def braking_margins_m(q_rad: npt.ArrayLike, q_dot_rad_s: npt.ArrayLike, config: RobotConfig) -> F64:
    """The smallest margins (9,) [m] on the way to rest, when all arms brake from here; in the order of PAIRS.

    q_dot_rad_s: the joints' speeds (9,) [rad/s]. Each brakes at its own acceleration, so they come to rest one after
    the other.
    """
    g = _guard(config)
    q, v = (np.ascontiguousarray(x, np.float64) for x in (q_rad, q_dot_rad_s))
    return _followed(*g.model, q, v, g.rate, _LOOKS)


def brakes_clear(q_rad: F64, q_dot_rad_s: F64, config: RobotConfig) -> bool:
    """Whether no margin of :func:`braking_margins_m` falls below what it has to keep; joints and speeds (9,)."""
    g = _guard(config)
    return bool(_keeps(*g.model, g.lever_m, q_rad, q_dot_rad_s, g.rate, g.least_m, _LOOKS))
