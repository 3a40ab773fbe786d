"""Angle figures against numbers worked out by hand."""

import numpy as np
import pytest

from teleop.body.parts import N_PARTS
from teleop.config.intent import AngleConfig, MappingConfig, TaskConfig
from teleop.evaluation import testers as protocol
from teleop.evaluation.angle_figures import (
    ANGLES,
    AnglePairs,
    angle_figure,
    angle_pairs,
    by_angle,
    right_bins,
    right_task,
)
from teleop.evaluation.answers import Answers
from teleop.evaluation.metrics import part_accuracy
from teleop.joints import JOINT_INDEX


def pairs(true: dict[str, list[float]], found: dict[str, list[float]]) -> AnglePairs:
    count = len(next(iter(true.values())))
    columns = [np.full((count, len(ANGLES)), np.nan) for _ in range(2)]
    for column, values in zip(columns, (true, found), strict=True):
        for name, numbers in values.items():
            column[:, ANGLES.index(name)] = numbers
    return AnglePairs(columns[0], columns[1], np.ones((count, 4)))


def test_errors_leave_the_unanswered_out_but_say_so() -> None:
    f = angle_figure(np.array([10.0, 20.0, 30.0, 40.0]), np.array([12.0, 19.0, np.nan, 43.0]))
    assert (f.n, f.answered) == (4, 0.75)
    assert f.mean == pytest.approx(2.0)
    assert f.bias == pytest.approx(4 / 3)


def test_steps_of_15_degrees_are_judged_away_from_edges() -> None:
    # 15 and 20 lie in the step of 15; 22 is too near the edge at 22.5; 96 is past the last edge and counts as 90
    p = pairs({"theta1_right": [15.0, 20.0, 22.0, 96.0]}, {"theta1_right": [22.0, 23.0, 40.0, 85.0]})
    assert right_bins(p, MappingConfig(), 2.0, 0.5) == (pytest.approx(2 / 3), 3)


def test_no_answer_is_a_wrong_step() -> None:
    p = pairs({"theta2_left": [45.0, 60.0]}, {"theta2_left": [45.0, np.nan]})
    assert right_bins(p, MappingConfig(), 2.0, 0.5) == (0.5, 2)


def test_short_projections_are_left_out() -> None:
    p = pairs({"theta1_right": [45.0, 45.0]}, {"theta1_right": [45.0, 80.0]})
    p.share[1, 0] = 0.3
    assert right_bins(p, MappingConfig(), 2.0, 0.5) == (1.0, 1)


def test_task_by_the_threshold() -> None:
    p = pairs({"T1": [3.0, 22.0, 22.0, 3.0]}, {"T1": [4.0, 15.0, 11.0, np.nan]})
    assert right_task(p, TaskConfig()) == (0.5, 4)


def test_error_by_true_angle() -> None:
    true = np.array([11.0] * 5 + [25.0] * 5)
    found = true + np.array([1.0] * 5 + [-2.0] * 5)
    assert by_angle(true, found) == [(15.0, 1.0, 1.0, 5), (25.0, -2.0, 2.0, 5)]


def arm_answers(true_deg: list[float], found_deg: list[float], tilt_deg: float) -> Answers:
    """Right arms raised sideways, the sensor tilted, the floor seen by the tracker."""
    t = np.radians(tilt_deg)
    R = np.array([[1, 0, 0], [0, np.cos(t), -np.sin(t)], [0, np.sin(t), np.cos(t)]])
    count = len(true_deg)
    joints = []
    for angles in (true_deg, found_deg):
        body = np.zeros((count, 20, 3))
        for f, degrees in enumerate(angles):
            a = np.radians(degrees)
            body[f, JOINT_INDEX["elbow_right"]] = 0.3 * np.array([np.sin(a), -np.cos(a), 0.0])
            body[f, JOINT_INDEX["wrist_right"]] = 0.5 * np.array([np.sin(a), -np.cos(a), 0.0])
        joints.append(body @ R.T)
    level = np.broadcast_to(R.T, (count, 3, 3))
    seen = np.ones((count, 20), bool)
    groups = np.arange(count) // 2
    confusion = np.zeros((N_PARTS, N_PARTS), np.int64)
    levels = np.array([30.0, 60.0] * (count // 2))
    return Answers(joints[1], seen.astype(float), joints[0], seen, level, level, groups, levels, seen[:, 0], confusion)


def test_angles_are_levelled() -> None:
    answers = arm_answers([30.0, 60.0], [33.0, 55.0], tilt_deg=15.0)
    true, found = angle_pairs(answers, AngleConfig()).of("theta1_right")
    assert true == pytest.approx([30.0, 60.0])
    assert found == pytest.approx([33.0, 55.0])


def test_largest_error_of_the_mean_over_testers() -> None:
    # at 30 the two testers are off by +4 and -2, at 60 by +3 and +5
    curve = protocol.tester_curve(arm_answers([30.0, 60.0, 30.0, 60.0], [34.0, 63.0, 28.0, 65.0], 0.0), "theta1")
    assert curve.levels == [30.0, 60.0]
    assert curve.mean == pytest.approx([1.0, 4.0])
    assert curve.spread == pytest.approx([3.0, 1.0])
    assert curve.largest == pytest.approx(4.0)


def test_part_accuracy() -> None:
    confusion = np.array([[8, 2, 0], [5, 5, 0], [0, 0, 0]])
    right, balanced = part_accuracy(confusion)
    assert right == pytest.approx(13 / 20)
    assert balanced == pytest.approx((0.8 + 0.5) / 2)
