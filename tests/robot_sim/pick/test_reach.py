"""The inverse of an arm's reach, and the greenhouse seen from the upper body."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robot_sim.arm_links import link_poses
from robot_sim.clearance import arms_rad
from robot_sim.commands import ARM_NAMES, ArmName, ArmTarget
from robot_sim.config import RobotConfig
from robot_sim.reach import angles_for_hands, arm_for_hand, hand_in_base, hand_in_chest
from robot_sim.stance import Stance
from robot_sim.urdf_parts_chassis import DISC_HEIGHT_M
from robot_sim.urdf_parts_tools import GRIP_M

CONFIG = RobotConfig()
DOWN = ArmTarget(0, 0, 180)


@settings(max_examples=200, deadline=None)
@given(st.sampled_from(ARM_NAMES), st.floats(-20, 115), st.floats(-25, 85), st.floats(55, 178), st.floats(0, 0.2))
def test_the_angles_for_a_hand_lead_it_there(arm: ArmName, c1: float, c2: float, elbow: float, beyond: float) -> None:
    point = hand_in_chest(arm, ArmTarget(c1, c2, elbow), beyond, CONFIG)
    found = arm_for_hand(arm, point, beyond, CONFIG)
    assert found is not None
    assert hand_in_chest(arm, found, beyond, CONFIG) == pytest.approx(point, abs=1e-9)


def test_what_is_out_of_reach_has_no_angles() -> None:
    assert arm_for_hand("right", (2.0, 0.0, 0.0), GRIP_M, CONFIG) is None
    # straight beside the shoulder the upper arm would have to pass through it
    assert arm_for_hand("right", (0.08, -0.42, 0.0), GRIP_M, CONFIG) is None
    many = angles_for_hands("right", np.array([[2.0, 0.0, 0.0], [0.5, -0.1, -0.2]]), GRIP_M, CONFIG)
    assert np.isnan(many[0]).all() and np.isfinite(many[1]).all()


def test_disc_and_chest_axes_agree_with_the_links() -> None:
    target = ArmTarget(40, 10, 130)
    R, p = link_poses(arms_rad({"right": target, "left": DOWN, "rear": DOWN}), CONFIG)
    grip = p[2] + R[2] @ np.array([0.0, 0.0, -CONFIG.arm.forearm_m - GRIP_M])
    chest = hand_in_chest("right", target, GRIP_M, CONFIG)
    assert grip - [0.0, 0.0, DISC_HEIGHT_M] == pytest.approx(chest, abs=1e-12)
    stance = Stance(0.0, 0.0, 0.0, 0.25, 0.4)
    base = hand_in_base("right", target, GRIP_M, 0.25, 0.4, CONFIG)
    assert stance.to_world(grip, CONFIG) == pytest.approx(base, abs=1e-12)


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-4, 4), st.floats(0, 0.4), st.floats(-3, 3))
def test_a_stance_takes_points_there_and_back(x: float, y: float, yaw: float, lift: float, disc: float) -> None:
    stance = Stance(x, y, yaw, lift, disc)
    points = np.array([[0.1, -0.2, 1.1], [1.5, 0.4, 0.9]])
    assert stance.to_world(stance.to_disc(points, CONFIG), CONFIG) == pytest.approx(points, abs=1e-9)
    ahead = stance.driven(0.5)
    assert np.hypot(ahead.x_m - x, ahead.y_m - y) == pytest.approx(0.5)
