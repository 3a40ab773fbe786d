"""The Jacobian against finite differences; the damped solver on many arms, limits and free directions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robot_sim.arms.plantlet import plantlet_arm
from robot_sim.arms.rb03 import grape_arm
from robot_sim.arms.tomato import tomato_arm
from robot_sim.errors import RobotError
from robot_sim.kinematics import IkReason, solve_dls
from robot_sim.kinematics.transforms import (
    inverse_pose,
    pose_error,
    rot_y,
    rotation_between,
    rpy,
    to_quaternion,
    to_rpy,
)

CHAINS = {a.chain.name: a.chain for a in (grape_arm(), plantlet_arm(), tomato_arm())}
angle = st.floats(-3.1, 3.1)


@pytest.mark.parametrize("name", CHAINS)
def test_jacobian_is_the_derivative_of_forward(name: str) -> None:
    chain = CHAINS[name]
    rng = np.random.default_rng(3)
    h = 1e-6
    for q in rng.uniform(-1.5, 1.5, (20, chain.n)):
        steps = [pose_error(chain.forward(q - h * e), chain.forward(q + h * e)) / (2 * h) for e in np.eye(chain.n)]
        np.testing.assert_allclose(chain.jacobian(q), np.array(steps).T, atol=1e-8)


@pytest.mark.parametrize("name", CHAINS)
def test_damped_solver_reaches_poses_inside_the_limits(name: str) -> None:
    chain = CHAINS[name]
    rng = np.random.default_rng(4)
    solved = 0
    for q in rng.uniform(chain.lower * 0.9, chain.upper * 0.9, (60, chain.n)):
        T = chain.forward(q)
        result = solve_dls(chain, T, np.zeros(chain.n))
        if result.ok:
            solved += 1
            assert chain.within_limits(result.q)
            assert np.abs(chain.forward(result.q[0]) - T).max() < 1e-9
    assert solved >= 57


def test_damped_solver_with_free_directions_reaches_a_point() -> None:
    chain = CHAINS["cherry_tomato_arm"]
    T = np.eye(4)
    T[:3, 3] = (0.6, 0.3, 0.7)
    result = solve_dls(chain, T, np.zeros(5), weight=(1, 1, 1, 0, 0, 0))
    assert result.ok
    np.testing.assert_allclose(chain.forward(result.q[0])[:3, 3], T[:3, 3], atol=1e-9)


def test_damped_solver_says_how_far_it_got() -> None:
    chain = CHAINS["gsk_rb03"]
    T = np.eye(4)
    T[:3, 3] = (3.0, 0.0, 0.0)
    result = solve_dls(chain, T, np.zeros(6))
    assert result.reason is IkReason.NOT_CONVERGED and not result.ok
    assert "mm" in result.detail and result.residual_m > 2.0
    with pytest.raises(RobotError, match="weight"):
        solve_dls(chain, T, np.zeros(6), weight=(0, 0, 0, 0, 0, 0))


@settings(max_examples=60)
@given(angle, st.floats(-1.5, 1.5), angle)
def test_rotation_conversions_agree(roll: float, pitch: float, yaw: float) -> None:
    T = rpy(roll, pitch, yaw)
    np.testing.assert_allclose(rpy(*to_rpy(T)), T, atol=1e-12)
    x, y, z, w = to_quaternion(T)
    R = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    np.testing.assert_allclose(R, T[:3, :3], atol=1e-12)
    np.testing.assert_allclose(inverse_pose(T) @ T, np.eye(4), atol=1e-12)
    turned = rotation_between((0, 0, 1), T[:3, 2])
    np.testing.assert_allclose(turned[:3, 2], T[:3, 2], atol=1e-12)


def test_half_a_turn_has_a_rotation_vector_of_pi() -> None:
    e = pose_error(np.eye(4), rot_y(np.pi))
    np.testing.assert_allclose(np.abs(e), [0, 0, 0, 0, np.pi, 0], atol=1e-9)
