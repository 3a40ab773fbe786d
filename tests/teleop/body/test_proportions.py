"""Arms that are out of proportion with the rest of the body are put right, others left alone."""

from __future__ import annotations

import numpy as np
import pytest

from teleop.body.model import load_model
from teleop.body.proportions import NOBODYS_M, in_proportion, size_of
from teleop.config.body import ProportionsConfig
from teleop.joints import BONES, JOINT_INDEX, N_JOINTS

CONFIG = ProportionsConfig()
SPREAD_M = np.full(N_JOINTS, 0.005)
BONES_M = load_model().bones_m
ARM = [JOINT_INDEX[f"{name}_right"] for name in ("shoulder", "elbow", "wrist")]


def body(size: float, seed: int = 0) -> np.ndarray:
    """Bones of training's mean times a size, in random directions."""
    rng = np.random.default_rng(seed)
    joints = np.tile([0.0, 0.0, 2.3], (N_JOINTS, 1))
    for (parent, child), length in zip(BONES, BONES_M, strict=True):
        way = rng.normal(0, 1, 3)
        joints[child] = joints[parent] + size * length * way / np.linalg.norm(way)
    return joints


def arm_m(joints: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.diff(joints[ARM], axis=0), axis=1)


@pytest.mark.parametrize("size", [0.8, 1.0, 1.25])
def test_trunk_and_legs_tell_the_size(size: float) -> None:
    assert size_of(body(size), SPREAD_M, BONES_M, CONFIG.sure_m) == pytest.approx(size)
    spread = SPREAD_M.copy()
    spread[[JOINT_INDEX[f"{n}_{s}"] for n in ("knee", "ankle") for s in ("right", "left")]] = 0.2
    assert size_of(body(size), spread, BONES_M, CONFIG.sure_m) is None


def test_a_body_in_proportion_stays_as_it_is() -> None:
    joints = body(1.1)
    assert (in_proportion(joints, SPREAD_M, BONES_M, NOBODYS_M, CONFIG) == joints).all()


@pytest.mark.parametrize("size", [0.9, 1.2])
def test_a_far_too_short_forearm_becomes_nearly_as_long_as_it_should_be(size: float) -> None:
    joints = body(size)
    true_m = arm_m(joints)
    elbow = joints[ARM[1]].copy()
    joints[ARM[1]] = elbow + 0.5 * (joints[ARM[2]] - elbow)
    spread = SPREAD_M.copy()
    spread[ARM[1]] = 0.02
    found = in_proportion(joints, spread, BONES_M, NOBODYS_M, CONFIG)
    before, after = abs(arm_m(joints) / true_m - 1).max(), abs(arm_m(found) / true_m - 1).max()
    assert before > 0.4 and after < 0.5 * before
    others = [j for j in range(N_JOINTS) if j not in ARM]
    assert (found[others] == joints[others]).all()


def test_an_operator_of_whom_the_arm_is_known_may_have_any_proportions() -> None:
    joints = body(1.0)
    joints[ARM[2]] = joints[ARM[1]] + 1.3 * (joints[ARM[2]] - joints[ARM[1]])
    left = [JOINT_INDEX[f"{name}_left"] for name in ("elbow", "wrist")]
    joints[left[1]] = joints[left[0]] + 1.3 * (joints[left[1]] - joints[left[0]])
    assert (in_proportion(joints, SPREAD_M, BONES_M, arm_m(joints), CONFIG) == joints).all()
    assert (in_proportion(joints, SPREAD_M, BONES_M, NOBODYS_M, CONFIG) != joints).any()


def test_unknown_joints_stay_unknown_and_it_can_be_left_out() -> None:
    joints = body(1.0)
    joints[ARM[2]] = np.nan
    found = in_proportion(joints, SPREAD_M, BONES_M, NOBODYS_M, CONFIG)
    assert np.isnan(found[ARM[2]]).all() and (found[ARM[:2]] == joints[ARM[:2]]).all()
    joints[ARM[1]] += 0.3
    off = ProportionsConfig(enabled=False)
    assert np.array_equal(in_proportion(joints, SPREAD_M, BONES_M, NOBODYS_M, off), joints, equal_nan=True)
