"""The learned correction: neighbours, unknown joints, limit."""

import numpy as np

from teleop.body.correction import N_CUES, N_NEIGHBOURS, NEIGHBOURS, corrected
from teleop.joints import JOINT_INDEX, N_JOINTS


def test_neighbours_follow_the_limb() -> None:
    near = set(NEIGHBOURS[JOINT_INDEX["elbow_right"]].tolist())
    assert {JOINT_INDEX["shoulder_right"], JOINT_INDEX["wrist_right"]} <= near
    assert JOINT_INDEX["knee_right"] not in near


def test_no_joint_moves_farther_than_the_limit_and_unknown_stays_unknown() -> None:
    rng = np.random.default_rng(0)
    joints = rng.normal(0, 0.5, (N_JOINTS, 3))
    joints[4] = np.nan
    weights = rng.normal(0, 1, (N_JOINTS, N_CUES, 3))
    out = corrected(joints, weights, np.zeros((N_JOINTS, N_NEIGHBOURS, 3)), 0.05)
    moved = np.linalg.norm(out - joints, axis=1)
    assert np.nanmax(moved) <= 0.05 + 1e-12
    assert np.isnan(out[4]).all()
    assert not np.isnan(np.delete(out, 4, axis=0)).any()


def test_constant_cue_moves_by_its_weight() -> None:
    weights = np.zeros((N_JOINTS, N_CUES, 3))
    weights[:, -1] = [0.01, 0.0, -0.02]
    joints = np.zeros((N_JOINTS, 3))
    out = corrected(joints, weights, np.zeros((N_JOINTS, N_NEIGHBOURS, 3)), 0.05)
    np.testing.assert_allclose(out, np.tile([0.01, 0.0, -0.02], (N_JOINTS, 1)))
