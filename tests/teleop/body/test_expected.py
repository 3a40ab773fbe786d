"""Joints are expected to go on nearly as they went."""

import numpy as np
import pytest

from teleop.body.expected import GOES_ON, expect, follow
from teleop.joints import N_JOINTS


def test_nothing_is_expected_of_nobody_and_the_same_of_who_was_seen_once() -> None:
    assert expect(None, 0.033) is None
    joints = np.random.default_rng(0).normal(size=(N_JOINTS, 3))
    once = expect(follow(None, joints, 0.033), 0.033)
    assert once is not None and (once == joints).all()


@pytest.mark.parametrize("dt_s", [1 / 30, 0.1])
def test_joints_go_on_by_the_time_that_passes(dt_s: float) -> None:
    joints = np.zeros((N_JOINTS, 3))
    course = follow(follow(None, joints, dt_s), joints + 0.02, dt_s)
    assert course.velocity_m_s == pytest.approx(0.02 / dt_s)
    found = expect(course, 2.0 * dt_s)
    assert found is not None and found == pytest.approx(0.02 + 2.0 * GOES_ON * 0.02)
