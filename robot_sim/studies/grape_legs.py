"""Legs of a pick in time: smooth through their key points, straighter where the smooth way would cut a corner."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from robot_sim.kinematics import SphericalWristArm
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.trajectories import Sequence, Trajectory, quintic, slowed_to_limits, via_points

BETWEEN = (0, 1, 3)
"""Points put between key points, one try after the other; the last try rests at every key point."""
FINE_S = 0.004


@dataclass(frozen=True, slots=True, eq=False)
class Legs:
    """Motions of one pick: start -> ready -> picking point -> ready -> basket. straightened: legs not plain smooth."""

    out: Trajectory
    pick: Trajectory
    back: Trajectory
    basket: Trajectory
    straightened: int = 0


def _times(arm: SphericalWristArm, q: FloatArray, speed_m_s: float) -> FloatArray:
    p = arm.chain.forward(q)[:, :3, 3]
    way = np.linalg.norm(np.diff(p, axis=0), axis=1) / speed_m_s
    turn = np.abs(np.diff(q, axis=0)).max(axis=1) / (0.5 * float(arm.chain.speed.min()))
    return np.maximum(way, turn)


def smooth_leg(arm: SphericalWristArm, q: FloatArray, speed_m_s: float, between: int = 0) -> Trajectory:
    """Quintic via-point motion through joint key points (K, 6) at about the tool speed, inside the joint speeds.

    between: so many points more on each straight joint segment; they hold the curve to the segments.
    """
    rows = [q[:1]]
    for a, b in pairwise(q):
        rows.append(a + np.linspace(0, 1, between + 2)[1:, None] * (b - a))
    points = np.concatenate(rows)
    t = np.concatenate([[0.0], np.cumsum(np.maximum(_times(arm, points, speed_m_s), 0.05 / (between + 1)))])
    return slowed_to_limits(via_points(points, t), arm.chain.speed)


def straight_leg(arm: SphericalWristArm, q: FloatArray, speed_m_s: float) -> Trajectory:
    """The straight joint segments themselves, at rest at every key point."""
    lengths = np.maximum(_times(arm, q, speed_m_s), 0.1)
    parts = [quintic(a, b, float(s)) for (a, b), s in zip(pairwise(q), lengths, strict=True)]
    return slowed_to_limits(Sequence(tuple(parts)), arm.chain.speed)


def swept_rows(arm: SphericalWristArm, leg: Trajectory, step_m: float, step_rad: float = 0.06) -> FloatArray:
    """Joint values (M, 6) along a motion, the tool no further than step_m and no joint more than step_rad apart."""
    q = leg.sample(FINE_S).q
    p = arm.chain.forward(q)[:, :3, 3]
    way = np.linalg.norm(np.diff(p, axis=0), axis=1) / step_m
    steps = np.concatenate([[0.0], np.cumsum(np.maximum(way, np.abs(np.diff(q, axis=0)).max(axis=1) / step_rad))])
    marks = np.linspace(0.0, steps[-1], int(np.ceil(steps[-1])) + 1)
    return np.asarray(q[np.minimum(np.searchsorted(steps, marks), len(q) - 1)])


def free_leg(
    arm: SphericalWristArm, q: FloatArray, speed_m_s: float, hits: Callable[[Trajectory], str]
) -> tuple[Trajectory, str, bool]:
    """The smoothest motion through key points (K, 6) that hits nothing.

    hits: what a motion runs into, '' for nothing. Returns the motion, what even the straight one runs into, and
    whether it had to be made straighter.
    """
    for between in BETWEEN:
        leg = smooth_leg(arm, q, speed_m_s, between)
        if not hits(leg):
            return leg, "", between > 0
    leg = straight_leg(arm, q, speed_m_s)
    return leg, hits(leg), True
