"""The rig: bones keep their length, limbs point where the pose says, trunk joints follow the specification."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teleop.joints import JOINT_INDEX
from teleop.people.builtin import builtin_body
from teleop.people.moves import random_pose
from teleop.people.pose import pose_rig, swing, unit, yaw
from teleop.people.rig import BONE, PARENT, joints_m
from teleop.people.shape import Shape

BODY = builtin_body(Shape(height_m=1.80))


def joint(joints, name):
    return joints[JOINT_INDEX[name]]


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1))
def test_bones_keep_their_length_in_any_pose(seed):
    posed = pose_rig(BODY.rig, random_pose(np.random.default_rng(seed)))
    for b, parent in enumerate(PARENT):
        if parent >= 0:
            rest = np.linalg.norm(BODY.rig.head_m[b] - BODY.rig.head_m[parent])
            assert np.linalg.norm(posed.p_m[b] - posed.p_m[parent]) == pytest.approx(rest, abs=1e-9)


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1))
def test_every_bone_turns_by_a_proper_rotation(seed):
    R = pose_rig(BODY.rig, random_pose(np.random.default_rng(seed))).R
    assert np.allclose(R @ R.transpose(0, 2, 1), np.eye(3), atol=1e-9)
    assert np.allclose(np.linalg.det(R), 1.0)


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1))
def test_limbs_point_where_the_pose_says(seed):
    pose = random_pose(np.random.default_rng(seed))
    joints = joints_m(BODY.rig, pose_rig(BODY.rig, pose))
    for side, arm, leg in zip(("right", "left"), pose.arms, pose.legs, strict=True):
        for a, b, wanted in (
            ("shoulder", "elbow", arm.upper),
            ("elbow", "wrist", arm.fore),
            ("hip", "knee", leg.thigh),
            ("knee", "ankle", leg.shin),
        ):
            d = unit(joint(joints, f"{b}_{side}") - joint(joints, f"{a}_{side}"))
            assert np.allclose(d, unit(wanted), atol=1e-6), (side, a, b)


@settings(max_examples=25)
@given(st.integers(0, 2**32 - 1))
def test_trunk_joints_lie_on_the_line_from_hips_to_shoulders(seed):
    joints = joints_m(BODY.rig, pose_rig(BODY.rig, random_pose(np.random.default_rng(seed))))
    hips = 0.5 * (joint(joints, "hip_right") + joint(joints, "hip_left"))
    shoulders = 0.5 * (joint(joints, "shoulder_right") + joint(joints, "shoulder_left"))
    assert np.allclose(joint(joints, "hip_center"), hips + 0.20 * (shoulders - hips))
    assert np.allclose(joint(joints, "spine"), hips + 0.37 * (shoulders - hips))


def test_the_operators_right_is_at_positive_x():
    for bone in ("upper_arm", "forearm", "hand", "thigh", "shin", "foot"):
        assert BODY.rig.head_m[BONE[f"{bone}_right"], 0] > 0 > BODY.rig.head_m[BONE[f"{bone}_left"], 0]


def test_a_rigid_motion_moves_all_joints_alike():
    posed = pose_rig(BODY.rig, random_pose(np.random.default_rng(5)))
    R, t = yaw(0.7), np.array([0.3, -1.0, 2.0])
    assert np.allclose(joints_m(BODY.rig, posed.moved(R, t)), joints_m(BODY.rig, posed) @ R.T + t)


@settings(max_examples=50)
@given(st.integers(0, 2**32 - 1))
def test_swing_takes_one_direction_to_the_other(seed):
    rng = np.random.default_rng(seed)
    a, b = unit(rng.normal(size=3)), unit(rng.normal(size=3))
    assert np.allclose(swing(a, b) @ a, b, atol=1e-9)


def test_swing_to_the_opposite_direction():
    a = unit(np.array([0.2, -0.9, 0.1]))
    assert np.allclose(swing(a, -a) @ a, -a, atol=1e-9)
