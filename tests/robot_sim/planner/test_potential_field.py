"""Paths of the potential field: clear of every solid, out of traps, close to bunches; key points stay clear."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from robot_sim.errors import RobotError
from robot_sim.kinematics.transforms import rpy, translation
from robot_sim.planner import (
    Box,
    Cylinder,
    FieldConfig,
    PathReason,
    Scene,
    Sphere,
    box,
    key_points,
    path_length,
    plan_path,
    rrt_connect,
    sphere,
    thinned,
    upright_cylinder,
)

POINT = (np.zeros((1, 3)), np.array([0.015]))


@pytest.mark.parametrize(
    "solid",
    [
        Sphere(translation(0.1, -0.2, 0.3), 0.1),
        Cylinder(translation(0.1, 0.0, 0.2) @ rpy(0.3, 0.4, 0.5), 0.08, 0.2),
        Box(translation(0.0, 0.1, 0.0) @ rpy(-0.3, 0.2, 0.9), (0.1, 0.05, 0.2)),
    ],
)
def test_distance_is_the_distance_and_the_normal_its_gradient(solid: Sphere | Cylinder | Box) -> None:
    rng = np.random.default_rng(0)
    p = rng.uniform(-0.5, 0.5, (400, 3))
    d, n = solid.distance(p)
    np.testing.assert_allclose(np.linalg.norm(n, axis=1), 1, atol=1e-9)
    # stepping back by the distance along the normal lands on the surface
    outside = d > 0
    assert outside.sum() > 100
    foot = p[outside] - d[outside, None] * n[outside]
    np.testing.assert_allclose(solid.distance(foot)[0], 0, atol=1e-9)
    h = 1e-6
    smooth = outside & (d > 1e-3)
    for k in range(3):
        e = np.zeros(3)
        e[k] = h
        slope = (solid.distance(p[smooth] + e)[0] - solid.distance(p[smooth] - e)[0]) / (2 * h)
        np.testing.assert_allclose(slope, n[smooth, k], atol=2e-3)
    assert (solid.grown(0.02).distance(p[outside])[0] <= d[outside] - 0.02 + 1e-9).all()


def test_free_space_is_crossed_in_a_straight_line() -> None:
    result = plan_path((0, 0, 0), (0.5, 0.2, 0.1), Scene(()), *POINT)
    assert result.ok and result.minima == 0
    assert path_length(result.points) == pytest.approx(np.sqrt(0.3), rel=1e-3)


@pytest.mark.parametrize("seed", range(12))
def test_random_scenes_give_clear_paths(seed: int) -> None:
    rng = np.random.default_rng(seed)
    start, goal = np.array([-0.5, 0.0, 0.0]), np.array([0.5, 0.0, 0.0])
    solids = []
    while len(solids) < 7:
        centre = rng.uniform((-0.4, -0.25, -0.25), (0.4, 0.25, 0.25))
        kind = rng.integers(3)
        solid = (
            sphere(centre, rng.uniform(0.04, 0.12))
            if kind == 0
            else upright_cylinder(centre, rng.uniform(0.04, 0.1), 0.25)
            if kind == 1
            else box(centre, rng.uniform(0.05, 0.2, 3))
        )
        if solid.distance(np.stack([start, goal]))[0].min() > 0.05:
            solids.append(solid)
    scene = Scene(tuple(solids))
    result = plan_path(start, goal, scene, *POINT)
    assert result.ok, result.reason
    fine = np.concatenate([np.linspace(a, b, 6) for a, b in pairwise(result.points)])
    assert scene.clearance(fine, *POINT).min() > 0.0
    points = key_points(result.points, scene, *POINT, margin_m=0.002, spacing_m=0.07)
    assert len(points) <= len(result.points)
    assert np.linalg.norm(np.diff(points, axis=0), axis=1).max() <= 0.07 + 1e-9
    dense = np.concatenate([np.linspace(a, b, 20) for a, b in pairwise(points)])
    assert scene.clearance(dense, *POINT).min() > 0.0
    np.testing.assert_allclose(points[[0, -1]], [start, goal], atol=1e-12)


def trap() -> Scene:
    """A cup that opens towards the start: the way straight to the goal ends at its bottom."""
    back = box((0.1, 0.0, 0.0), (0.02, 0.4, 0.4))
    sides = [box((0.0, s * 0.2, 0.0), (0.22, 0.02, 0.4)) for s in (-1, 1)]
    lids = [box((0.0, 0.0, s * 0.2), (0.22, 0.4, 0.02)) for s in (-1, 1)]
    return Scene((back, *sides, *lids))


def test_a_cup_is_a_local_minimum_and_is_left() -> None:
    start, goal = (-0.3, 0.0, 0.0), (0.4, 0.0, 0.0)
    stuck = plan_path(start, goal, trap(), *POINT, config=FieldConfig(escapes=0))
    assert stuck.reason is PathReason.LOCAL_MINIMUM and len(stuck.points) == 0
    result = plan_path(start, goal, trap(), *POINT)
    assert result.ok and result.minima >= 1
    assert result.clearance_m >= FieldConfig().margin_m


def test_a_goal_close_to_a_bunch_is_still_reached() -> None:
    scene = Scene((upright_cylinder((0.0, 0.0, -0.11), 0.06, 0.2),))
    result = plan_path((-0.4, 0.1, -0.1), (0.0, 0.0, 0.03), scene, np.zeros((1, 3)), np.array([0.01]))
    assert result.ok
    np.testing.assert_allclose(result.points[-1], (0, 0, 0.03))


def test_blocked_ends_and_closed_rooms_have_reasons() -> None:
    ball = Scene((sphere((0.0, 0.0, 0.0), 0.1),))
    assert plan_path((0, 0, 0), (1, 0, 0), ball, *POINT).reason is PathReason.START_BLOCKED
    assert plan_path((1, 0, 0), (0, 0, 0), ball, *POINT).reason is PathReason.GOAL_BLOCKED
    room = Scene(tuple(box(np.eye(3)[k] * s * 0.2, 0.42 - 0.4 * np.eye(3)[k]) for k in range(3) for s in (-1, 1)))
    locked = plan_path((0, 0, 0), (0.6, 0, 0), room, *POINT, config=FieldConfig(escapes=3))
    assert locked.reason in (PathReason.LOCAL_MINIMUM, PathReason.TOO_LONG) and not locked.ok
    with pytest.raises(RobotError, match="radii"):
        plan_path((0, 0, 0), (1, 0, 0), ball, np.zeros((2, 3)), np.array([0.1]))


def test_thinning_keeps_the_shape() -> None:
    t = np.linspace(0, np.pi, 200)
    arc = np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)
    few = thinned(arc, 0.005)
    assert 5 < len(few) < 40
    nearest = np.min(
        [np.linalg.norm(arc - (a + s * (b - a)), axis=1) for a, b in pairwise(few) for s in np.linspace(0, 1, 30)],
        axis=0,
    )
    assert nearest.max() < 0.008


def test_rrt_connect_finds_the_gap_and_says_when_there_is_none() -> None:
    def gap(q: np.ndarray) -> bool:
        return not (abs(q[0]) < 0.1 and not 0.5 < q[1] < 0.8)

    low, high = np.full(2, -1.0), np.full(2, 1.0)
    found = rrt_connect((-0.8, 0.0), (0.8, 0.0), low, high, gap, np.random.default_rng(1))
    assert found.ok and found.checks > 10
    assert all(gap(q) for q in found.path)
    assert np.abs(np.diff(found.path, axis=0)).max() <= 0.08 + 1e-9
    np.testing.assert_allclose(found.path[[0, -1]], [(-0.8, 0), (0.8, 0)])
    closed = rrt_connect(
        (-0.8, 0.0), (0.8, 0.0), low, high, lambda q: bool(abs(q[0]) > 0.1), np.random.default_rng(1), iterations=60
    )
    assert not closed.ok
