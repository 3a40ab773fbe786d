"""The angle study: its figures by hand, and one tester through the chain."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from teleop.data import data_root
from teleop.studies.angle_chain import MOVEMENTS, AngleSpec, Movement, Reading, arm_of, protocol
from teleop.studies.angle_errors import curve, reached_error_deg, run_angle_study


def reading(tester: int, level: float, captured: float, sent: float, movement: Movement = "forward") -> Reading:
    return Reading(tester, movement, level, "right", level, captured, sent, sent + 0.5, stood=True, held=False)


def test_an_error_is_that_of_the_mean_over_the_testers() -> None:
    readings = [
        *(reading(0, 20.0, 23.0, 15.0) for _ in range(3)),
        reading(1, 20.0, 15.0, 15.0),
        reading(0, 50.0, 51.0, 45.0),
        reading(1, 50.0, np.nan, 60.0),
        reading(0, 90.0, 150.0, 150.0, "elbow_across"),
    ]
    forward = curve(readings, "forward")
    assert forward.error == pytest.approx([-1.0, 1.0])
    assert forward.spread == pytest.approx([4.0, 0.0])
    assert forward.largest == pytest.approx(1.0)
    assert (forward.same_step, forward.answered) == pytest.approx((5 / 6, 5 / 6))
    assert np.isnan(forward.clear_step), "20 and 50 degrees lie beside the edges at 22.5 and 52.5"
    across = curve(readings, "elbow_across")
    assert across.largest == pytest.approx(60.0) and np.isnan(across.same_step)


def test_what_moves_or_is_held_back_with_a_reason_is_no_error_of_the_servo() -> None:
    still = reading(0, 20.0, 20.0, 15.0)
    moving = Reading(0, "forward", 20.0, "left", 20.0, 20.0, 15.0, 0.0, stood=False, held=False)
    held = Reading(0, "sideways", 90.0, "left", 90.0, 90.0, 90.0, 67.0, stood=True, held=True)
    unsent = Reading(0, "sideways", 90.0, "left", 90.0, 90.0, np.nan, 0.0, stood=True, held=False)
    assert reached_error_deg([still, moving, held, unsent]) == pytest.approx([0.5])


def test_every_level_is_held_and_read_at_its_end() -> None:
    motion, rests = protocol(AngleSpec(0, 0))
    assert (
        {arm_of(0, movement) for movement in MOVEMENTS} == {"right", "left"} == {arm_of(n, "forward") for n in (0, 1)}
    )
    assert len(rests) == 9 + 9 + 10 + 10
    for rest in rests:
        first, last = motion.at(rest.from_s).pose, motion.at(rest.until_s).pose
        assert np.degrees(np.arccos(np.clip(first.arms[0].upper @ last.arms[0].upper, -1, 1))) < 3.0


@pytest.mark.data
def test_the_robot_s_arm_goes_where_the_person_s_does(tmp_path: Path) -> None:
    root = data_root()
    if root is None or not (root / "makehuman").is_dir():
        pytest.skip("needs the data set makehuman (TELEOP_DATA)")
    study = run_angle_study(tmp_path, operators=1, size=(320, 240), every=8, workers=1, movements=("forward",))
    forward = study.curves[0]
    assert forward.level.tolist() == [10.0, 90.0] and forward.answered == 1.0
    assert forward.true == pytest.approx(forward.level, abs=2.0)
    assert forward.sent[1] > 60.0 and forward.sent[0] < 20.0
    assert 0.1 < study.reached_deg < 0.8 and study.at_rest > 0.5
    assert (tmp_path / "angle_errors.png").is_file() and "captured" in study.page.read_text(encoding="utf-8")
