"""Closed-form inverses return every true configuration, only true ones, and name what cannot be had."""

from __future__ import annotations

import numpy as np
import pytest

from robot_sim.arms.plantlet import plantlet_arm
from robot_sim.arms.rb03 import grape_arm
from robot_sim.arms.tomato import tomato_arm
from robot_sim.errors import RobotError
from robot_sim.kinematics import IkReason, Joint, SphericalWristArm
from robot_sim.kinematics.closed_form import ClosedFormArm
from robot_sim.kinematics.transforms import rot_x, rot_y

ARMS = {"grape": grape_arm(), "plantlet": plantlet_arm(), "tomato": tomato_arm()}


def independent(arm: ClosedFormArm, q: np.ndarray) -> np.ndarray:
    """The joint values that the pose determines: the tomato arm's first two only by their sum."""
    if arm.chain.name == "cherry_tomato_arm":
        return np.concatenate([q[..., :1] + q[..., 1:2], q[..., 2:]], axis=-1)
    return q


@pytest.mark.parametrize("name", ARMS)
def test_every_true_configuration_is_among_the_branches(name: str) -> None:
    arm = ARMS[name]
    rng = np.random.default_rng(11)
    q = rng.uniform(arm.chain.lower, arm.chain.upper, (100_000, arm.chain.n))
    # off singularities: a joint that a singular pose leaves free has no true value
    T = arm.chain.forward(q)
    batch = arm.inverse_batch(T)
    keep = batch.singular == 0
    assert keep.mean() > 0.999
    gap = independent(arm, q)[:, None, :] - independent(arm, batch.q)
    gap = np.abs((gap + np.pi) % (2 * np.pi) - np.pi).max(axis=2)
    gap[~batch.reached] = np.inf
    assert gap[keep].min(axis=1).max() < 1e-6
    # no wrong answer: every branch that is called valid reaches the pose and keeps the limits
    for b in range(batch.q.shape[1]):
        valid = batch.valid[:, b]
        if valid.any():
            solutions = batch.q[valid, b]
            assert np.abs(arm.chain.forward(solutions) - T[valid]).max() < 1e-9
            assert arm.chain.within_limits(solutions, 1e-8)
    assert batch.valid[keep].any(axis=1).all()


@pytest.mark.parametrize("name", ARMS)
def test_unreachable_is_named_with_numbers(name: str) -> None:
    arm = ARMS[name]
    T = arm.chain.forward(np.full(arm.chain.n, 0.4))
    T[:3, 3] *= 10
    result = arm.inverse(T)
    assert result.reason is IkReason.UNREACHABLE and not result.ok
    assert "covers" in result.detail


@pytest.mark.parametrize("name", ["plantlet", "tomato"])
def test_five_joints_refuse_an_orientation_off_their_family(name: str) -> None:
    arm = ARMS[name]
    T = arm.chain.forward(np.array([0.3, -0.8, 1.1, 0.4, 0.2]))
    T[:3, :3] = T[:3, :3] @ (rot_x(0.2) @ rot_y(0.3))[:3, :3]
    result = arm.inverse(T)
    assert not result.ok
    assert result.reason in (IkReason.ORIENTATION, IkReason.UNREACHABLE)


def test_joint_limits_are_a_reason_and_the_branches_are_shown() -> None:
    joints = [Joint(f"j{i}", lower=-0.1, upper=0.1) for i in range(6)]
    arm = SphericalWristArm.from_lengths("tight", (0.1, 0.3, 0.05, 0.3), joints)
    result = arm.inverse(arm.chain.forward(np.full(6, 0.5)))
    assert result.reason is IkReason.JOINT_LIMIT
    assert len(result.beyond_limits) >= 1 and len(result.q) == 0
    assert "j" in result.detail


@pytest.mark.parametrize(
    ("q", "named"),
    [
        ((0.3, -0.9, 0.4, 0.2, 0.0, 0.1), "wrist"),
        ((0.3, -0.9, np.arctan2(0.07, 0.27) - np.pi / 2, 0.2, 0.7, 0.1), "elbow"),
    ],
)
def test_singular_poses_are_named_and_still_solved(q: tuple[float, ...], named: str) -> None:
    arm = grape_arm()
    T = arm.chain.forward(np.array(q))
    result = arm.inverse(T, q_ref=q)
    assert result.ok and result.reason is IkReason.SINGULAR
    assert named in result.singular
    for solution in result.q:
        np.testing.assert_allclose(arm.chain.forward(solution), T, atol=1e-6)
    np.testing.assert_allclose(result.nearest(q), q, atol=1e-5)


def test_wrist_centre_on_the_base_axis_is_a_shoulder_singularity() -> None:
    arm = grape_arm()
    T = np.eye(4)
    T[:3, 3] = (0.0, 0.0, 0.55)
    result = arm.inverse(T)
    assert "shoulder" in result.singular


def test_tomato_redundancy_keeps_the_sum_and_moves_least() -> None:
    arm = tomato_arm()
    q = np.array([2.9, -1.0, 0.5, 0.4, -0.3])
    T = arm.chain.forward(q)
    for ref in (np.zeros(5), np.array([1.0, 1.0, 0, 0, 0]), np.array([-3.0, 2.5, 0, 0, 0])):
        result = arm.inverse(T, q_ref=ref)
        assert result.ok
        assert np.cos(result.q[0, 0] + result.q[0, 1] - 1.9) == pytest.approx(1.0, abs=1e-12)
        assert arm.chain.within_limits(result.q)
    low, high = arm.theta1_range(1.9)
    assert low == pytest.approx(1.9 - np.radians(170)) and high == pytest.approx(np.pi)


def test_wrong_calls_raise_with_one_line() -> None:
    arm = grape_arm()
    bent = np.eye(4)
    bent[0, 0] = 1.2
    for bad in (np.eye(3), bent, np.full((4, 4), np.nan)):
        with pytest.raises(RobotError) as caught:
            arm.inverse(bad)
        assert "\n" not in str(caught.value)
    with pytest.raises(RobotError, match="6 joints"):
        arm.chain.forward([0.0, 1.0])
