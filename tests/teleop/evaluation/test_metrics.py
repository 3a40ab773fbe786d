"""Figures against numbers worked out by hand."""

import numpy as np
import pytest

from teleop.config.intent import AngleConfig
from teleop.evaluation.angle_figures import ANGLES, body_angles_deg
from teleop.evaluation.metrics import average_precision, joint_figures
from teleop.evaluation.section import table
from teleop.joints import JOINT_INDEX


def test_joint_figures() -> None:
    truth = np.zeros((4, 1, 3))
    found = np.zeros((4, 1, 3))
    found[0, 0, 0], found[1, 0, 0], found[2, 0, 0] = 0.05, 0.2, np.nan
    counted = np.array([[True], [True], [True], [False]])
    f = joint_figures(found, np.ones((4, 1)), truth, counted)
    assert f.count[0] == 3
    assert f.answered[0] == pytest.approx(2 / 3)
    assert f.near[0] == pytest.approx(1 / 3)
    assert f.mean_m[0] == pytest.approx(0.125)


def test_average_precision_punishes_sure_errors() -> None:
    yes = np.ones(4, bool)
    near = np.array([True, True, False, True])
    sure_of_error = average_precision(near, np.array([0.5, 0.6, 0.9, 0.7]), yes, yes)
    doubtful_error = average_precision(near, np.array([0.5, 0.6, 0.1, 0.7]), yes, yes)
    assert doubtful_error == pytest.approx(0.75)
    assert sure_of_error == pytest.approx((1 / 2 + 2 / 3 + 3 / 4) / 4)


def test_angles_of_a_bent_arm() -> None:
    joints = np.full((1, 20, 3), np.nan)
    for name, p in (("shoulder", (0, 0, 2)), ("elbow", (0.3, 0, 2)), ("wrist", (0.3, 0.3, 2))):
        joints[0, JOINT_INDEX[f"{name}_right"]] = p
    visible = np.ones((1, 20), bool)
    found = dict(zip(ANGLES, body_angles_deg(joints, visible, AngleConfig())[0], strict=True))
    assert found["theta1_right"] == pytest.approx(90)
    assert found["theta3_right"] == pytest.approx(90)
    assert np.isnan(found["theta1_left"]) and np.isnan(found["T1"])
    visible[0, JOINT_INDEX["wrist_right"]] = False
    assert np.isnan(body_angles_deg(joints, visible, AngleConfig())[0, 2])


def test_table_is_markdown() -> None:
    assert table(("a", "b"), [["1", "2"]]).splitlines() == ["| a | b |", "| --- | ---: |", "| 1 | 2 |"]
