"""Joint and part tables: order, mirror, bones; the floor's levelling rotation."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleop.body.parts import MIRROR_PART, N_PARTS, PART_NAMES
from teleop.joints import BONES, JOINT_INDEX, JOINT_NAMES, MIRROR_JOINT, N_JOINTS
from teleop.skeleton import FloorPlane, Skeleton


def test_the_sources_order() -> None:
    assert N_JOINTS == 20
    assert JOINT_NAMES[0] == "head"
    assert JOINT_NAMES[4] == "spine"
    assert JOINT_NAMES[19] == "shoulder_left"


def test_mirror_is_an_involution_that_swaps_sides() -> None:
    for table, names in ((MIRROR_JOINT, JOINT_NAMES), (MIRROR_PART, PART_NAMES)):
        for i, j in enumerate(table):
            assert table[j] == i
            assert names[i].replace("right", "*").replace("left", "*") == names[j].replace("right", "*").replace(
                "left", "*"
            )
            assert (i == j) == ("right" not in names[i] and "left" not in names[i])


def test_bones_join_all_joints_in_one_tree() -> None:
    assert len(BONES) == N_JOINTS - 1
    reached = {JOINT_INDEX["spine"]}
    while more := {j for pair in BONES if set(pair) & reached for j in pair} - reached:
        reached |= more
    assert len(reached) == N_JOINTS


def test_joint_parts_come_first() -> None:
    assert PART_NAMES[:N_JOINTS] == JOINT_NAMES
    assert N_PARTS == 30


def test_unknown_joint_is_none() -> None:
    joints = np.zeros((20, 3))
    joints[JOINT_INDEX["head"]] = np.nan
    skeleton = Skeleton(0, joints, np.ones(20))
    assert skeleton.joint("head") is None
    assert skeleton.joint("spine") is not None


@given(pitch=st.floats(-0.5, 0.5), roll=st.floats(-0.3, 0.3))
def test_levelling_is_a_rotation_that_makes_the_floor_flat(pitch: float, roll: float) -> None:
    up = np.array([np.sin(roll), np.cos(roll) * np.cos(pitch), np.sin(pitch) * np.cos(roll)])
    R = FloorPlane(up, 1.0).R_level_camera()
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(R) == pytest.approx(1.0)
    np.testing.assert_allclose(R @ up, [0, 1, 0], atol=1e-12)
    assert (R @ [0, 0, 1])[0] == pytest.approx(0.0, abs=1e-12), "yaw is kept: forward stays forward"
