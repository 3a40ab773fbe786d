"""How near the arms come to each other, to the trunk and to the ends of their workspace.

Capsule distances (Ericson, Real-Time Collision Detection, section 5.1.9), for the limiter at every tick and for
whoever plans a command.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
from numba import njit

from robot_sim.arm_angles import joint_rad
from robot_sim.arm_links import forward
from robot_sim.capsules import ArmModel, arm_model
from robot_sim.commands import ARM_NAMES, ArmName, ArmTarget
from robot_sim.config import RobotConfig
from robot_sim.derived import derived

F64 = npt.NDArray[np.float64]
_T, _M, _V = "float64[:,:,:,::1]", "float64[:,:,::1]", "float64[::1]"

TRUNK, WORKSPACE = -1, -2
PAIRS: tuple[tuple[int, int], ...] = (
    (0, 1),
    (0, 2),
    (1, 2),
    *((arm, TRUNK) for arm in range(3)),
    *((arm, WORKSPACE) for arm in range(3)),
)
"""Order of the margins: right-left, right-rear, left-rear, each arm with the trunk, each tool with its workspace."""


@njit(f"float64({_V}, {_V}, {_V}, {_V})", cache=True, nogil=True)
def _segments(p1, q1, p2, q2):  # type: ignore[no-untyped-def]
    """Distance of two segments; either may be a point."""
    a = e = f = c = b = 0.0
    for i in range(3):
        d1, d2, r = q1[i] - p1[i], q2[i] - p2[i], p1[i] - p2[i]
        a += d1 * d1
        e += d2 * d2
        f += d2 * r
        c += d1 * r
        b += d1 * d2
    s = t = 0.0
    if a > 1e-12 and e > 1e-12:
        denominator = a * e - b * b
        if denominator > 1e-12:
            s = min(1.0, max(0.0, (b * f - c * e) / denominator))
        t = (b * s + f) / e
        if t < 0.0:
            t, s = 0.0, min(1.0, max(0.0, -c / a))
        elif t > 1.0:
            t, s = 1.0, min(1.0, max(0.0, (b - c) / a))
    elif a > 1e-12:
        s = min(1.0, max(0.0, -c / a))
    elif e > 1e-12:
        t = min(1.0, max(0.0, f / e))
    total = 0.0
    for i in range(3):
        d = p1[i] + s * (q1[i] - p1[i]) - p2[i] - t * (q2[i] - p2[i])
        total += d * d
    return np.sqrt(total)


@njit(f"void(int64[::1], {_M}, {_V}, {_M}, float64[:,::1], {_V})", cache=True, nogil=True)
def _gaps(body, ends, radius, R, p, gaps):  # type: ignore[no-untyped-def]
    """Smallest gap of the first six PAIRS into gaps (6,) [m]; negative where capsules overlap."""
    n = len(body)
    world = ends.copy()
    for k in range(n):
        link = body[k]
        if link >= 0:
            for side in range(2):
                for a in range(3):
                    total = p[link, a]
                    for m in range(3):
                        total += R[link, a, m] * ends[k, side, m]
                    world[k, side, a] = total
    middle, half = np.zeros((n, 3)), np.zeros(n)
    for k in range(n):
        total = 0.0
        for a in range(3):
            middle[k, a] = 0.5 * (world[k, 0, a] + world[k, 1, a])
            total += (world[k, 1, a] - world[k, 0, a]) ** 2
        half[k] = 0.5 * np.sqrt(total) + radius[k]
    gaps[:] = np.inf
    for i in range(n):
        for j in range(i + 1, n):
            arm_i = body[i] // 3 if body[i] >= 0 else -1
            arm_j = body[j] // 3 if body[j] >= 0 else -1
            if arm_i == arm_j:
                continue
            if arm_i == -1 or arm_j == -1:
                mover = body[j] if arm_i == -1 else body[i]
                if mover % 3 != 2:
                    continue  # an upper arm begins at the trunk
                pair = 3 + mover // 3
            else:
                pair = arm_i + arm_j - 1
            between = 0.0
            for a in range(3):
                between += (middle[i, a] - middle[j, a]) ** 2
            if np.sqrt(between) - half[i] - half[j] >= gaps[pair]:
                continue  # cannot be the nearest
            gap = _segments(world[i, 0], world[i, 1], world[j, 0], world[j, 1]) - radius[i] - radius[j]
            if gap < gaps[pair]:
                gaps[pair] = gap


@njit(f"void(float64[:,::1], {_V}, {_M}, float64[:,::1], {_V})", cache=True, nogil=True)
def _inside(tip, limits, R, p, out):  # type: ignore[no-untyped-def]
    """How far each tool's end is inside the workspace, into out (3,) [m]; limits: reach, low, high."""
    for arm in range(3):
        at = np.zeros(3)
        for a in range(3):
            at[a] = p[3 * arm + 2, a]
            for m in range(3):
                at[a] += R[3 * arm + 2, a, m] * tip[arm, m]
        reach = limits[0] - np.sqrt(at[0] ** 2 + at[1] ** 2)
        out[arm] = min(reach, min(at[2] - limits[1], limits[2] - at[2]))


@njit(f"{_V}({_T}, {_M}, int64[::1], {_M}, {_V}, float64[:,::1], {_V}, {_V})", cache=True, nogil=True)
def pose_margins(T_joint, axis, body, ends, radius, tip, limits, q):  # type: ignore[no-untyped-def]
    """Margins (9,) [m] of one pose. limits: reach, low, high."""
    R, p = np.zeros((9, 3, 3)), np.zeros((9, 3))
    forward(T_joint, axis, q, R, p)
    out = np.empty(9)
    _gaps(body, ends, radius, R, p, out[:6])
    _inside(tip, limits, R, p, out[6:])
    return out


def margins_m(q_rad: npt.ArrayLike, config: RobotConfig) -> F64:
    """Margins (9,) [m] in the order of PAIRS for the arms' joints (9,) [rad]: C1, C2, elbow of right, left, rear arm.

    Forearms and tools count against the trunk; jaws count as open. Negative: shapes overlap, or a tool is outside.
    """
    m: ArmModel = arm_model(config)
    q = np.ascontiguousarray(q_rad, np.float64)
    return pose_margins(m.T_joint, m.axis, m.body, m.ends_m, m.radius_m, m.tip_m, workspace(config), q)


@derived
def workspace(config: RobotConfig) -> F64:
    """Reach, low and high end of the tools' workspace (3,) [m]."""
    c = config.clearance
    return np.array([c.reach_m, c.low_m, c.high_m])


@derived
def least_margins_m(config: RobotConfig) -> F64:
    """What every margin (9,) has to keep [m]: between arms with the reserve in which they brake."""
    c = config.clearance
    return np.array([c.arm_gap_m + c.reserve_m] * 3 + [c.body_gap_m] * 3 + [0.0] * 3)


def arms_rad(targets: Mapping[ArmName, ArmTarget]) -> F64:
    """Joint angles (9,) [rad] of three arm targets, in the order that :func:`margins_m` takes."""
    return np.array([q for arm in ARM_NAMES for q in joint_rad(targets[arm], arm).values()])


def breaches(before_m: F64, after_m: F64, config: RobotConfig) -> tuple[tuple[int, int], ...]:
    """The PAIRS whose margin (9,) falls below what is allowed and the reserve between arms, and below what it was.

    Moving apart is always allowed: nobody gets stuck.
    """
    return tuple(PAIRS[i] for i in np.flatnonzero(after_m < np.minimum(least_margins_m(config), before_m - 1e-9)))
