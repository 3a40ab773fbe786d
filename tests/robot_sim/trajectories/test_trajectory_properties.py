"""Ends, continuity and limits of every kind of trajectory, as properties; jtraj and ctraj against the toolbox."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robot_sim.arms.plantlet import plantlet_arm
from robot_sim.arms.tomato import tomato_arm
from robot_sim.errors import RobotError
from robot_sim.kinematics import IkReason
from robot_sim.kinematics.transforms import rot_x, rot_z, rpy, translation
from robot_sim.trajectories import (
    DriveLine,
    Sequence,
    Trajectory,
    cubic,
    find_breaches,
    follow_line,
    quintic,
    slowed_to_limits,
    trapezoid,
    via_points,
)

joints = st.lists(st.floats(-3, 3), min_size=3, max_size=3)
seconds = st.floats(0.2, 10)


def derivative_errors(trajectory: Trajectory) -> tuple[float, float]:
    """How far qd and qdd are from central differences of q and qd, where both sides exist."""
    h = trajectory.duration_s * 1e-5
    t = np.linspace(2 * h, trajectory.duration_s - 2 * h, 501)
    low, mid, high = trajectory.at(t - h), trajectory.at(t), trajectory.at(t + h)
    scale_v, scale_a = 1 + np.abs(mid.qd).max(), 1 + np.abs(mid.qdd).max()
    speed = np.abs((high.q - low.q) / (2 * h) - mid.qd).max() / scale_v
    return speed, np.abs((high.qd - low.qd) / (2 * h) - mid.qdd).max() / scale_a


@settings(max_examples=40)
@given(joints, joints, seconds)
def test_polynomials_meet_their_ends_and_are_consistent(a: list[float], b: list[float], T: float) -> None:
    for make in (cubic, quintic):
        trajectory = make(a, b, T)
        ends = trajectory.at([0.0, T])
        np.testing.assert_allclose(ends.q, [a, b], atol=1e-9)
        np.testing.assert_allclose(ends.qd, 0, atol=1e-8)
        if make is quintic:
            np.testing.assert_allclose(ends.qdd, 0, atol=1e-6)
        assert max(derivative_errors(trajectory)) < 1e-4


@settings(max_examples=40)
@given(joints, joints, joints, joints, joints, joints, seconds)
def test_quintic_meets_given_speeds_and_accelerations(
    a: list[float], b: list[float], u: list[float], w: list[float], s: list[float], e: list[float], T: float
) -> None:
    ends = quintic(a, b, T, u, w, s, e).at([0.0, T])
    np.testing.assert_allclose(ends.q, [a, b], atol=1e-8)
    np.testing.assert_allclose(ends.qd, [u, w], atol=1e-7)
    np.testing.assert_allclose(ends.qdd, [s, e], atol=1e-6)


def test_quintic_has_the_sources_coefficients() -> None:
    T, D, s, e = 3.0, 1.2, 0.7, -0.4
    a = quintic([0.5], [0.5 + D], T, acc0=[s], accf=[e]).coefficients[:, 0]
    printed = [0.5, 0, s / 2, (20 * D - (3 * s - e) * T**2) / (2 * T**3)]
    printed += [(-30 * D + (3 * s - 2 * e) * T**2) / (2 * T**4), (12 * D - (s - e) * T**2) / (2 * T**5)]
    np.testing.assert_allclose(a, printed, atol=1e-12)


@settings(max_examples=60)
@given(joints, joints, st.floats(0.1, 5), st.floats(0.1, 20))
def test_trapezoid_keeps_and_uses_its_limits(a: list[float], b: list[float], speed: float, acc: float) -> None:
    trajectory = trapezoid(a, b, speed, acc)
    ends = trajectory.at([0.0, trajectory.duration_s])
    np.testing.assert_allclose(ends.q, [a, b], atol=1e-9)
    np.testing.assert_allclose(ends.qd, 0, atol=1e-6)
    if trajectory.duration_s > 0:
        m = trajectory.at(np.linspace(0, trajectory.duration_s, 400))
        assert np.abs(m.qd).max() <= speed * (1 + 1e-9)
        assert np.abs(m.qdd).max() <= acc * (1 + 1e-9)
        assert np.abs(m.qdd).max() == pytest.approx(acc) or np.abs(m.qd).max() == pytest.approx(speed, rel=0.02)
        assert np.abs(np.diff(m.q, axis=0)).max() <= speed * np.diff(m.t_s).max() * (1 + 1e-6)


@pytest.mark.parametrize("order", [3, 5])
@pytest.mark.parametrize("seed", range(5))
def test_via_points_are_met_with_continuous_acceleration(order: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    q, t = rng.uniform(-2, 2, (6, 4)), np.concatenate([[0], np.cumsum(rng.uniform(0.3, 1.5, 5))])
    trajectory = via_points(q, t, order)
    np.testing.assert_allclose(trajectory.at(t).q, q, atol=1e-9)
    np.testing.assert_allclose(trajectory.at([0, t[-1]]).qd, 0, atol=1e-9)
    if order == 5:
        np.testing.assert_allclose(trajectory.at([0, t[-1]]).qdd, 0, atol=1e-7)
    h = 1e-7
    before, after = trajectory.at(t[1:-1] - h), trajectory.at(t[1:-1] + h)
    np.testing.assert_allclose(before.qd, after.qd, atol=1e-4)
    np.testing.assert_allclose(before.qdd, after.qdd, atol=1e-2)


@pytest.mark.parametrize("make", [cubic, quintic])
def test_slowing_keeps_the_path_and_meets_the_limit(make: Callable[..., Trajectory]) -> None:
    fast = make([0, 0, 0], [1, -2, 3], 0.5)
    slow = slowed_to_limits(fast, speed=2.0, acceleration=30.0)
    m = slow.sample(0.001)
    assert np.abs(m.qd).max() <= 2.0 * 1.001
    assert np.abs(m.qdd).max() <= 30.0 * 1.001
    np.testing.assert_allclose(slow.at(slow.duration_s / 3).q, fast.at(0.5 / 3).q, atol=1e-9)
    assert slowed_to_limits(slow, speed=2.1).factor == 1.0


def test_breaches_name_joint_and_time() -> None:
    chain = tomato_arm().chain
    q2 = [-np.pi / 4, np.pi, 3 * np.pi / 4, -np.pi / 2, np.pi / 2]
    (over,) = [b for b in find_breaches(cubic(np.zeros(5), q2, 2.0), chain) if b.what != "speed"]
    assert (over.joint, over.what) == ("joint2", "upper limit")
    assert over.value == pytest.approx(np.pi) and over.limit == pytest.approx(np.radians(170))


def test_sequence_runs_its_parts_in_order_and_rests_between() -> None:
    first, second = quintic([0.0], [1.0], 1.0), quintic([1.0], [3.0], 2.0)
    both = Sequence((first, second), pause_s=0.5)
    assert both.duration_s == pytest.approx(3.5)
    m = both.at([0.5, 1.25, 2.5, 3.5])
    np.testing.assert_allclose(m.q[:, 0], [0.5, 1.0, 2.0, 3.0])
    assert m.qd[1, 0] == 0.0


def test_sampling_includes_the_end_at_any_rate() -> None:
    trajectory = quintic([0.0], [1.0], 1.0)
    for step in (0.3, 0.25, 1.0, 2.0):
        m = trajectory.sample(step)
        assert m.t_s[-1] == pytest.approx(1.0) and m.q[-1, 0] == pytest.approx(1.0)
        assert (np.diff(m.t_s) > 0).all()


def test_line_is_straight_and_keeps_its_orientation() -> None:
    arm = plantlet_arm()
    start = translation(0.25, 0.0, 0.02) @ rot_x(np.pi) @ rot_z(np.radians(30))
    line = DriveLine(start, np.array([0, 0, 0.08]), np.zeros(3))
    result = follow_line(arm, line, 4.0, 0.025, np.zeros(5))
    assert result.motion is not None
    T = arm.chain.forward(result.motion.q)
    np.testing.assert_allclose(T[:, :3, :3], np.broadcast_to(start[:3, :3], (161, 3, 3)), atol=1e-9)
    np.testing.assert_allclose(T[:, :2, 3], np.broadcast_to([0.25, 0.0], (161, 2)), atol=1e-9)
    np.testing.assert_allclose(T[:, 2, 3], 0.02 - 0.08 * np.linspace(0, 1, 161), atol=1e-9)


def test_line_that_leaves_the_workspace_says_where() -> None:
    arm = plantlet_arm()
    start = translation(0.25, 0.0, 0.02) @ rot_x(np.pi)
    result = follow_line(arm, DriveLine(start, np.array([1.0, 0, 0]), np.zeros(3)), 2.0, 0.02, np.zeros(5))
    assert result.motion is None and result.reason is IkReason.UNREACHABLE
    assert 0.1 < result.share < 0.3 and "covers" in result.detail


def test_jtraj_and_ctraj_equal_the_toolbox() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        rtb = pytest.importorskip("roboticstoolbox", reason="roboticstoolbox-python (extra dev) is not installed")
        from spatialmath import SE3
    rng = np.random.default_rng(2)
    for _ in range(5):
        a, b = rng.uniform(-3, 3, (2, 6))
        t = np.linspace(0, 2.0, 51)
        theirs = rtb.jtraj(a, b, t)
        ours = quintic(a, b, 2.0).at(t)
        np.testing.assert_allclose(ours.q, theirs.q, atol=1e-9)
        np.testing.assert_allclose(ours.qd, theirs.qd, atol=1e-9)
        np.testing.assert_allclose(ours.qdd, theirs.qdd, atol=1e-9)
    T0, T1 = translation(0.1, 0.2, 0.3) @ rpy(0.1, 0.2, 0.3), translation(0.4, -0.1, 0.5) @ rpy(0.3, -0.2, 1.0)
    share = np.linspace(0, 1, 21)
    theirs_line = np.array([T.A for T in rtb.ctraj(SE3(T0), SE3(T1), s=share)])
    np.testing.assert_allclose(DriveLine.between(T0, T1).pose(share), theirs_line, atol=1e-9)


def test_wrong_calls_raise() -> None:
    with pytest.raises(RobotError, match="positive"):
        quintic([0.0], [1.0], 0.0)
    with pytest.raises(RobotError, match="one length"):
        cubic([0.0], [1.0, 2.0], 1.0)
    with pytest.raises(RobotError, match="rising"):
        via_points([[0.0], [1.0]], [0.0, 0.0])
    with pytest.raises(RobotError, match="order"):
        via_points([[0.0], [1.0]], [0.0, 1.0], order=4)
