"""Servo degrees, joints and directions: round trips and the equations written beside them."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_sim.arm_angles import (
    arm_target,
    forearm_direction,
    joint_rad,
    shoulder_from_direction,
    upper_arm_direction,
)
from robot_sim.commands import ARM_NAMES, ArmTarget

angles = st.floats(-85.0, 85.0)


@given(st.floats(-20.0, 120.0), st.floats(-10.0, 100.0), st.floats(55.0, 180.0), st.sampled_from(ARM_NAMES))
def test_joints_and_servo_angles_are_inverse(c1: float, c2: float, elbow: float, arm: str) -> None:
    target = ArmTarget(c1, c2, elbow)
    back = arm_target(joint_rad(target, arm), arm)
    assert (back.c1_deg, back.c2_deg, back.elbow_deg) == pytest.approx((c1, c2, elbow), abs=1e-9)


@given(st.floats(-170.0, 170.0), angles)
def test_direction_and_shoulder_angles_are_inverse(c1: float, c2: float) -> None:
    assert shoulder_from_direction(*upper_arm_direction(c1, c2)) == pytest.approx((c1, c2), abs=1e-6)


@given(angles, angles)
def test_c1_is_the_sources_theta2_and_theta1_follows_from_both(c1: float, c2: float) -> None:
    forward, outward, up = upper_arm_direction(c1, c2)
    assert math.degrees(math.atan2(forward, -up)) == pytest.approx(c1, abs=1e-9)
    theta1 = math.degrees(math.atan2(outward, -up))
    assert math.tan(math.radians(theta1)) == pytest.approx(
        math.tan(math.radians(c2)) / math.cos(math.radians(c1)), rel=1e-9, abs=1e-9
    )


def test_named_poses() -> None:
    assert upper_arm_direction(0, 0) == pytest.approx((0, 0, -1))
    assert upper_arm_direction(90, 0) == pytest.approx((1, 0, 0))
    assert upper_arm_direction(0, 90) == pytest.approx((0, 1, 0))
    assert forearm_direction(ArmTarget(0, 0, 90)) == pytest.approx((1, 0, 0))
    assert forearm_direction(ArmTarget(90, 0, 90)) == pytest.approx((0, 0, 1))
    assert forearm_direction(ArmTarget(30, 40, 180)) == pytest.approx(upper_arm_direction(30, 40))


def test_an_arm_straight_out_keeps_c1() -> None:
    assert shoulder_from_direction(0.0, 1.0, 0.0, held_c1_deg=37.0) == (37.0, 90.0)
    assert shoulder_from_direction(0.0, 0.0, 0.0, held_c1_deg=37.0) == (37.0, 0.0)
