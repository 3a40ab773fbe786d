"""Ways between two postures of both arms: straight, one arm after the other, round what is in the way, or sampled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from robot_sim.config import RobotConfig
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.pick.arm_space import ArmSpace, Carried
from robot_sim.planner import FieldConfig, key_points, plan_path, rrt_connect
from robot_sim.reach import angles_for_hands
from robot_sim.trajectories import Trajectory, slowed_to_limits, via_points
from robot_sim.urdf_parts_chassis import DISC_HEIGHT_M
from robot_sim.urdf_parts_tools import GRIP_M

STEP_RAD = 0.04
"""Postures looked at along a way are no further apart."""
BEND_RAD = 0.35
"""Via points of a motion are about so far apart."""
RADII_M = np.array([0.075, 0.045, 0.040])
ALONG_M = np.array([0.0, 0.06, 0.16])
"""The hand as balls: round the open jaws, and back along the forearm."""


def straight(q0: FloatArray, q1: FloatArray) -> FloatArray:
    """Postures (M, n) from one to the other, straight in joint space."""
    count = max(2, int(np.ceil(np.abs(q1 - q0).max() / STEP_RAD)) + 1)
    return np.asarray(q0 + np.linspace(0.0, 1.0, count)[:, None] * (q1 - q0))


def through(corners: FloatArray) -> FloatArray:
    """Postures along a polyline of corners (K, n)."""
    parts = [straight(a, b)[1:] for a, b in pairwise(corners)]
    return np.concatenate([corners[:1], *parts])


def hand_line(space: ArmSpace, q0: FloatArray, q1: FloatArray, count: int = 9) -> FloatArray | None:
    """Postures (count, 6) whose right grip point moves along a straight line; None where the arm cannot.

    The left arm goes straight in joint space.
    """
    line = grip(space, q0) + np.linspace(0.0, 1.0, count)[:, None] * (grip(space, q1) - grip(space, q0))
    right = _right(space, line)
    if right is None or np.abs(np.diff(right, axis=0)).max() > 0.5:
        return None
    left = np.linspace(q0[3:], q1[3:], count)
    return np.concatenate([right, left], axis=1)


def grip(space: ArmSpace, q: FloatArray) -> FloatArray:
    """The right grip point (3,) at a posture (6,), in the disc's axes [m]."""
    return space.point(q, 2, np.array([0.0, 0.0, -space.config.arm.forearm_m - GRIP_M]))


def right_for(space: ArmSpace, point_m: FloatArray) -> FloatArray | None:
    """The right arm's angles (3,) that bring its grip to a point (3,) of the disc's axes; None where none do."""
    q = _right(space, point_m[None])
    return None if q is None else q[0]


def _right(space: ArmSpace, points_m: FloatArray) -> FloatArray | None:
    """The same for many points; None unless all can be reached inside the joints' ranges."""
    q = angles_for_hands("right", points_m - np.array([0.0, 0.0, DISC_HEIGHT_M]), GRIP_M, space.config)
    arm = space.config.arm
    lower, upper = (np.array([getattr(a, end) for a in (arm.c1, arm.c2, arm.elbow)]) for end in ("lower", "upper"))
    return q if ((q >= lower) & (q <= upper)).all() else None


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """Postures (M, 6) from start to goal, and how they were found: straight, in_turn, field or tree."""

    postures: FloatArray
    found_by: str


def find_way(
    space: ArmSpace, q0: FloatArray, q1: FloatArray, carried: Carried | None, *, search: bool = True, seed: int = 0
) -> Way | None:
    """A free way from one posture (6,) to another; None when there is none, or none was found.

    search: beside the quick ways (straight, one arm after the other) the right hand's way through a potential field
    and a tree of sampled postures, which take longer.
    """
    free = space.check(carried)
    right_first, left_first = np.append(q1[:3], q0[3:]), np.append(q0[:3], q1[3:])
    quick = (("straight", (q0, q1)), ("in_turn", (q0, right_first, q1)), ("in_turn", (q0, left_first, q1)))
    for name, corners in quick:
        path = through(np.array(corners))
        if all(free(q) for q in path):
            return Way(path, name)
    if not search:
        return None
    field = _round_about(space, q0, q1)
    if field is not None and all(free(q) for q in field):
        return Way(field, "field")
    tree = _tree(space, q0, q1, free, seed)
    return None if tree is None else Way(tree, "tree")


def _round_about(space: ArmSpace, q0: FloatArray, q1: FloatArray) -> FloatArray | None:
    """The right hand through the potential field; the left arm moves when the right one has arrived."""
    back = (grip(space, q0) - space.point(q0, 2, np.zeros(3))) / (space.config.arm.forearm_m + GRIP_M)
    ball_m, gap_m = np.outer(-ALONG_M, back), space.config.pick.plant_gap_m
    field = FieldConfig(margin_m=gap_m, reach_m=0.10, steps=300, escapes=3, hops=150)
    found = plan_path(grip(space, q0), grip(space, q1), space.scene, ball_m, RADII_M, field)
    if not found.ok:
        return None
    keys = key_points(found.points, space.scene, ball_m, RADII_M, margin_m=gap_m, spacing_m=0.08)
    right = _right(space, keys)
    if right is None:
        return None
    corners = np.concatenate([right, np.broadcast_to(q0[3:], (len(right), 3))], axis=1)
    return through(np.concatenate([[q0], corners[1:-1], [np.append(q1[:3], q0[3:]), q1]]))


def _tree(
    space: ArmSpace, q0: FloatArray, q1: FloatArray, free: Callable[[FloatArray], bool], seed: int
) -> FloatArray | None:
    """RRT-Connect over the arms that have to move."""
    moves = np.abs(q1 - q0) > 1e-9
    arm = space.config.arm
    lower, upper = (np.tile([getattr(a, end) for a in (arm.c1, arm.c2, arm.elbow)], 2) for end in ("lower", "upper"))

    def whole(part: FloatArray) -> FloatArray:
        q = q0.copy()
        q[moves] = part
        return q

    found = rrt_connect(
        q0[moves],
        q1[moves],
        lower[moves],
        upper[moves],
        lambda part: free(whole(part)),
        np.random.default_rng(seed),
        step_rad=0.08,
        iterations=200,
        smoothing=40,
    )
    return np.array([whole(part) for part in found.path]) if found.ok else None


def timed(path: FloatArray, config: RobotConfig) -> Trajectory:
    """A smooth motion along postures (M, 6), at rest at both ends, inside picking's share of the limits."""
    arm, share = config.arm, config.pick.speed_share
    axes = [arm.c1, arm.c2, arm.elbow] * 2
    speed, acceleration = (share * np.array([getattr(a, name) for a in axes]) for name in ("speed", "acceleration"))
    keys = _spaced(path)
    # unequal stretches at one pace; slowing to the limits does the rest
    spans = np.maximum((np.abs(np.diff(keys, axis=0)) / speed).max(axis=1), 0.02)
    times = np.concatenate([[0.0], np.cumsum(spans)])
    return slowed_to_limits(via_points(keys, times, order=5), speed, acceleration, step_s=0.005)


def _spaced(path: FloatArray) -> FloatArray:
    """Few postures of a path: its ends, and between them about every BEND_RAD."""
    gone = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(path, axis=0)).max(axis=1))])
    count = max(1, round(float(gone[-1]) / BEND_RAD))
    marks = np.linspace(0.0, gone[-1], count + 1)
    return np.stack([np.interp(marks, gone, column) for column in path.T], axis=1)
