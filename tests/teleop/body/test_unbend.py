"""Elbows move across the line from shoulder to wrist: less bent where noise bends, more where caution straightens."""

import numpy as np
import pytest

from teleop.angles import angle_deg
from teleop.body.unbend import unbend
from teleop.config.body import ElbowConfig
from teleop.joints import JOINT_INDEX, N_JOINTS

S, E, W = (JOINT_INDEX[f"{n}_right"] for n in ("shoulder", "elbow", "wrist"))
SPREAD = np.full(N_JOINTS, 0.006)


def arm(bend_deg: float) -> np.ndarray:
    joints = np.full((N_JOINTS, 3), np.nan)
    bend = np.radians(bend_deg)
    joints[S], joints[E] = [0.2, 0.4, 2.2], [0.2, 0.12, 2.2]
    joints[W] = joints[E] + 0.25 * np.array([np.sin(bend), -np.cos(bend), 0.0])
    return joints


def bend_deg(joints: np.ndarray) -> float:
    found = angle_deg(joints[E] - joints[S], joints[W] - joints[E])
    assert found is not None
    return found


def test_a_straight_arm_under_noise_is_read_straight_on_the_mean() -> None:
    rng = np.random.default_rng(0)
    raw, meant = [], []
    for _ in range(400):
        joints = arm(0.0)
        joints[[S, E, W]] += rng.normal(0.0, 0.007, (3, 3))
        raw.append(bend_deg(joints))
        meant.append(bend_deg(unbend(joints, SPREAD, ElbowConfig())))
    assert np.mean(raw) > 4.0
    assert np.mean(meant) < 0.6 * np.mean(raw)


@pytest.mark.parametrize(("angle", "low", "high"), [(2.0, -2.1, -1.0), (20.0, -0.9, 0.0), (85.0, 0.3, 3.0)])
def test_small_bends_shrink_and_large_ones_grow(angle: float, low: float, high: float) -> None:
    change = bend_deg(unbend(arm(angle), SPREAD, ElbowConfig())) - angle
    assert low <= change <= high


def test_a_folded_arm_stays() -> None:
    np.testing.assert_array_equal(unbend(arm(125.0), SPREAD, ElbowConfig())[[S, E, W]], arm(125.0)[[S, E, W]])


def test_a_sure_elbow_stays_and_so_do_all_other_joints() -> None:
    joints = arm(85.0)
    after = unbend(joints, np.full(N_JOINTS, 1e-5), ElbowConfig())
    np.testing.assert_allclose(after[[S, E, W]], joints[[S, E, W]], atol=1e-6)
    unsure = unbend(joints, SPREAD, ElbowConfig())
    np.testing.assert_array_equal(unsure[[S, W]], joints[[S, W]])
    assert np.isnan(unsure[JOINT_INDEX["elbow_left"]]).all(), "what is unknown stays unknown"
    assert unbend(joints, SPREAD, ElbowConfig(enabled=False)) is joints
