"""The operator's body: reaches that are smooth and can be turned away, arms that are read as they were asked."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teleop.angles import arm_angles
from teleop.config import TeleopConfig
from teleop.joints import JOINT_INDEX
from teleop.operator_model.body import FIST, OPEN, ArmPosture, Pace, Posture, arm_key, standing
from teleop.operator_model.reach import resting
from teleop.people.rig import Floats
from teleop.skeleton import Skeleton

HANG = ArmPosture(5.0, 4.0, 168.0, 10.0)
PLACE = Posture(0.0, 2.1, 24.0, HANG, HANG, OPEN, OPEN)


def test_a_reach_ends_at_its_goal_at_rest_and_turns_away_without_a_jerk() -> None:
    first = resting(np.array([0.0])).towards(np.array([1.0]), 1.0, 1.0)
    assert first.at(1.0)[0] == pytest.approx(0.0)
    assert first.at(1.5)[0] == pytest.approx(0.5)
    for value, wanted in zip(first.at(2.0 - 1e-9), (1.0, 0.0, 0.0), strict=True):
        assert value == pytest.approx(wanted, abs=1e-5)
    second = first.towards(np.array([-1.0]), 1.4, 0.8)
    for before, after in zip(first.at(1.4), second.at(1.4), strict=True):
        assert after == pytest.approx(before)
    assert second.at(2.2)[0] == pytest.approx(-1.0)


@settings(max_examples=40, deadline=None)
@given(st.floats(-10.0, 40.0), st.floats(-5.0, 60.0), st.floats(60.0, 175.0), st.floats(0.0, 90.0))
def test_an_arm_is_read_by_the_angles_it_was_asked_for(side: float, front: float, elbow: float, swivel: float) -> None:
    key = arm_key(ArmPosture(side, front, elbow, swivel), 1.0, OPEN)
    joints = np.full((20, 3), np.nan)
    shoulder = np.array([0.2, 1.4, 2.0])
    joints[JOINT_INDEX["shoulder_right"]] = shoulder
    joints[JOINT_INDEX["elbow_right"]] = shoulder + 0.3 * key.upper
    joints[JOINT_INDEX["wrist_right"]] = shoulder + 0.3 * key.upper + 0.25 * key.fore
    read = arm_angles(Skeleton(0, joints, np.ones(20)), "right", TeleopConfig().intent.angles)
    assert read.theta1_deg == pytest.approx(abs(side), abs=1e-3)
    assert read.theta2_deg == pytest.approx(abs(front), abs=1e-3)
    assert read.theta3_deg == pytest.approx(elbow, abs=1e-3)


def test_a_body_takes_its_time_and_no_part_waits_for_another() -> None:
    body = standing(PLACE, Pace(), 3).ask(Posture(0.0, 1.8, 24.0, HANG, HANG, FIST, OPEN), 1.0)
    assert not body.done("place", 1.1) and not body.done("right_hand", 1.1) and body.done("left", 1.1)
    moment, body = body.at(1.1)
    assert 0.0 < moment.curl[0] < 1.0 and 1.8 < moment.z_m < 2.1
    moment, body = body.at(3.0)
    assert moment.curl == (FIST, OPEN) and moment.z_m == pytest.approx(1.8)


def test_where_a_reach_ends_is_off_by_a_persons_error_the_same_for_the_same_seed() -> None:
    lifted = Posture(0.0, 2.1, 24.0, ArmPosture(5.0, 45.0, 135.0, 10.0), HANG, OPEN, OPEN)

    def ends(seed: int, miss: float) -> Floats:
        return standing(PLACE, Pace(miss=miss), seed).ask(lifted, 0.0).parts["right"].goal

    assert ends(1, 0.0) == pytest.approx(np.array([5.0, 45.0, 135.0, 10.0]))
    assert (ends(1, 0.05) == ends(1, 0.05)).all() and (ends(1, 0.05) != ends(2, 0.05)).any()
    assert 0.1 < np.abs(ends(1, 0.05) - ends(1, 0.0)).max() < 10.0
