"""Equations (8)-(21) against values worked out by hand."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stick_figure import Person, raised, skeleton, without

from teleop.angles import angle_deg, arm_angles, body_angles, leg_angles
from teleop.config.intent import AngleConfig
from teleop.joints import JOINT_INDEX
from teleop.skeleton import Skeleton

CONFIG = AngleConfig()


def posed(**places: tuple[float, float, float]) -> Skeleton:
    joints = np.full((20, 3), np.nan)
    for name, place in places.items():
        joints[JOINT_INDEX[name]] = place
    return Skeleton(0, joints, np.ones(20))


def test_golden_arm() -> None:
    # b0 = (0.3, -0.3, -0.1): b01 = (0.3, -0.3) is 45 deg from down; b02 = (-0.3, -0.1) is atan(1/3)
    body = posed(shoulder_right=(0.2, 0.5, 2.0), elbow_right=(0.5, 0.2, 1.9), wrist_right=(0.5, 0.5, 1.9))
    angles = arm_angles(body, "right", CONFIG)
    assert angles.theta1_deg == pytest.approx(45.0)
    assert angles.theta2_deg == pytest.approx(math.degrees(math.atan(1 / 3)))
    # b3 = (-0.3, 0.3, 0.1), b4 = (0, 0.3, 0): cos = 0.3 / sqrt(0.19)
    assert angles.theta3_deg == pytest.approx(math.degrees(math.acos(0.3 / math.sqrt(0.19))))


def test_golden_legs() -> None:
    # right (0.1, -0.4, 0), left (0, -0.4, -0.2): x-y: atan(1/4); y-z: atan(1/2)
    body = posed(hip_right=(0.1, 0, 2), knee_right=(0.2, -0.4, 2), hip_left=(-0.1, 0, 2), knee_left=(-0.1, -0.4, 1.8))
    T1, T2 = leg_angles(body, CONFIG)
    assert pytest.approx(math.degrees(math.atan(0.25))) == T1
    assert pytest.approx(math.degrees(math.atan(0.5))) == T2


@pytest.mark.parametrize("angle", [0, 10, 45, 60, 90])
@pytest.mark.parametrize("side", ["right", "left"])
def test_raised_arm_reads_its_angle_in_its_plane(angle: int, side: str) -> None:
    sideways = arm_angles(skeleton(Person(**{side: raised(outward_deg=angle)})), side, CONFIG)
    assert sideways.theta1_deg == pytest.approx(angle, abs=1e-6)
    assert sideways.theta3_deg == pytest.approx(180.0, abs=1e-4)
    forward = arm_angles(skeleton(Person(**{side: raised(forward_deg=angle)})), side, CONFIG)
    assert forward.theta2_deg == pytest.approx(angle, abs=1e-6)


def test_arm_at_the_sensor_has_no_frontal_angle() -> None:
    angles = arm_angles(skeleton(Person(right=raised(forward_deg=90))), "right", CONFIG)
    assert angles.theta1_deg is None
    assert angles.theta2_deg == pytest.approx(90.0)


def test_unknown_joints_give_no_answer() -> None:
    body = skeleton(Person())
    assert arm_angles(without(body, "wrist_right"), "right", CONFIG).theta3_deg is None
    assert arm_angles(without(body, "wrist_right"), "right", CONFIG).theta1_deg == pytest.approx(0.0, abs=1e-6)
    assert arm_angles(without(body, "elbow_left"), "left", CONFIG).theta1_deg is None
    assert leg_angles(without(body, "knee_left"), CONFIG) == (None, None)


def test_legs_of_the_figure() -> None:
    angles = body_angles(skeleton(Person(legs_apart_deg=30)), CONFIG)
    assert angles.T1_deg == pytest.approx(30.0)
    assert angles.T2_deg == pytest.approx(0.0, abs=1e-6)
    assert body_angles(skeleton(Person(stride_deg=20)), CONFIG).T2_deg == pytest.approx(20.0)


VECTORS = st.tuples(*[st.floats(-5, 5)] * 3).map(np.array)


@given(VECTORS, VECTORS, st.floats(0.01, 100))
def test_angle_is_symmetric_bounded_and_ignores_length(a: np.ndarray, b: np.ndarray, scale: float) -> None:
    angle = angle_deg(a, b)
    if angle is None:
        assert np.linalg.norm(a) * np.linalg.norm(b) == 0.0
        return
    assert 0.0 <= angle <= 180.0
    assert angle_deg(b, a) == pytest.approx(angle, abs=1e-9)
    if np.linalg.norm(a) > 1e-3 and np.linalg.norm(b) > 1e-3:
        assert angle_deg(a * scale, b) == pytest.approx(angle, abs=1e-4)
