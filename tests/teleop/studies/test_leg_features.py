"""The leg study: its angles and variances by hand, and legs that move as recorded ones do."""

import numpy as np
import pytest

from teleop.data import data_root
from teleop.joints import JOINT_INDEX
from teleop.studies.leg_features import PAIRS, pair_angles_deg, within_task_variance
from teleop.studies.mapping_difference import pointing_error_deg


def test_angles_in_space_of_the_six_pairs() -> None:
    joints = np.full((20, 3), np.nan)
    for side, x in (("right", 0.1), ("left", -0.1)):
        joints[JOINT_INDEX[f"hip_{side}"]] = (x, 0, 2)
        joints[JOINT_INDEX[f"knee_{side}"]] = (x + np.sign(x) * 0.4, -0.4, 2)  # 45 degrees out: 90 between them
        joints[JOINT_INDEX[f"ankle_{side}"]] = (x + np.sign(x) * 0.4, -0.8, 2)  # straight down: parallel
    angles = dict(zip(PAIRS, pair_angles_deg(joints), strict=True))
    assert angles["H-K"] == pytest.approx(90.0)
    assert angles["K-A"] == pytest.approx(0.0, abs=1e-6)
    assert angles["H-A"] == pytest.approx(2 * np.degrees(np.arctan2(0.4, 0.8)))
    assert np.isnan(angles["A-F"])


def test_variance_is_within_tasks_not_between_them() -> None:
    angles = np.repeat([[20.0], [20.0], [2.0], [4.0]], 6, axis=1)
    assert within_task_variance(angles, np.array([True, True, False, False])) == pytest.approx(np.full(6, 0.5))


@pytest.mark.data
def test_legs_move_as_recorded() -> None:
    root = data_root()
    if root is None or not (root / "cmu_mocap").is_dir() or not (root / "makehuman").is_dir():
        pytest.skip("needs the data sets cmu_mocap and makehuman (TELEOP_DATA)")
    from teleop.studies.leg_performance import perform

    samples = list(perform(2, 6, 0, (160, 120), burst=2))
    assert [[f.t_ns for f in s.frames] for s in samples[1:3]] == [
        [966_666_667, 1_000_000_000],
        [1_966_666_667, 2_000_000_000],
    ]
    assert (samples[1].frames[0].depth_mm != samples[1].frames[1].depth_mm).any()
    assert [s.picking for s in samples] == [True] * 3 + [False] * 3
    legs = [JOINT_INDEX[n] for n in ("knee_right", "knee_left", "ankle_right", "ankle_left")]
    moved = np.ptp([s.joints_m[legs] for s in samples[:3]], axis=0)
    assert moved.max() > 0.003, "frozen legs are no result"
    h_k = np.array([pair_angles_deg(s.joints_m)[0] for s in samples])
    assert (h_k[:3] > 12).all() and (h_k[3:] < 12).all()


@pytest.mark.parametrize("raised_deg", [0.0, 15.0, 45.0, 60.0])
def test_both_mappings_agree_in_the_two_planes_and_differ_between(raised_deg: float) -> None:
    for turned_deg in (0.0, 90.0):
        for mapping in ("paper", "direction"):
            assert pointing_error_deg(raised_deg, turned_deg, mapping, steps=False) == pytest.approx(0.0, abs=1e-3)
    assert pointing_error_deg(raised_deg, 45.0, "direction", steps=False) == pytest.approx(0.0, abs=1e-3)
    if raised_deg >= 45:
        assert pointing_error_deg(raised_deg, 45.0, "paper", steps=False) > 3.0
