"""Pointing at a fruit: the direction of an arm, the cone, the dwell, declining."""

from __future__ import annotations

import math

import numpy as np
import pytest
from stick_figure import HANGING, Arm, Person, raised, skeleton

from robot_sim.config import RobotConfig
from robot_sim.stance import Stance
from robot_sim.urdf_parts_arms import shoulder_pose
from teleop.assist.aim import Aim, arm_direction, pointed_at, step_aim
from teleop.config.assist import AssistConfig

ROBOT, CONFIG = RobotConfig(), AssistConfig()
STANCE = Stance(0.0, 0.0, 0.0, 0.1, 0.0)
FRUITS = {"ahead": (0.2, 0.60, 1.4), "beside": (0.5, 0.60, 1.4), "far": (0.2, 2.5, 1.4)}
DT_S = 1 / 30


def towards(name: str) -> np.ndarray:
    away = STANCE.to_disc(np.array(FRUITS[name]), ROBOT) - np.array(shoulder_pose("right", ROBOT)[0])
    return away / np.linalg.norm(away)


def test_a_raised_arm_points_and_a_bent_or_unseen_one_does_not() -> None:
    forward = arm_direction(skeleton(Person(right=raised(forward_deg=90))), "right", CONFIG)
    assert forward == pytest.approx([1.0, 0.0, 0.0], abs=0.02)
    outward = arm_direction(skeleton(Person(right=raised(outward_deg=90))), "right", CONFIG)
    assert outward == pytest.approx([0.0, -1.0, 0.0], abs=0.02)
    assert arm_direction(skeleton(Person(right=HANGING)), "right", CONFIG) == pytest.approx([0, 0, -1], abs=0.02)
    bent = Person(right=Arm((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
    assert arm_direction(skeleton(bent), "right", CONFIG) is None


def test_a_left_hander_points_with_the_left_arm_for_the_same_robot_arm() -> None:
    left = arm_direction(skeleton(Person(left=raised(outward_deg=90))), "left", CONFIG)
    assert left == pytest.approx([0.0, -1.0, 0.0], abs=0.02)


def test_the_fruit_on_the_line_is_meant_and_nothing_outside_the_cone() -> None:
    for name in ("ahead", "beside"):
        assert pointed_at(towards(name), STANCE, FRUITS, None, ROBOT, CONFIG) == name
    assert pointed_at(np.array([0.0, 0.0, -1.0]), STANCE, FRUITS, None, ROBOT, CONFIG) is None
    assert pointed_at(towards("ahead"), STANCE, {}, None, ROBOT, CONFIG) is None
    assert pointed_at(towards("far"), STANCE, {"far": FRUITS["far"]}, None, ROBOT, CONFIG) is None


def test_the_fruit_meant_before_stays_while_another_is_hardly_nearer() -> None:
    between = towards("ahead") + towards("beside")
    between /= np.linalg.norm(between)
    assert pointed_at(between, STANCE, FRUITS, "ahead", ROBOT, AssistConfig(cone_deg=45.0)) == "ahead"
    assert pointed_at(between, STANCE, FRUITS, "beside", ROBOT, AssistConfig(cone_deg=45.0)) == "beside"
    assert pointed_at(towards("beside"), STANCE, FRUITS, "ahead", ROBOT, AssistConfig(cone_deg=45.0)) == "beside"


def play(seconds: float, aim: Aim, raised: bool, fruit: str | None) -> tuple[Aim, list[str]]:
    decided = []
    for _ in range(round(seconds / DT_S)):
        aim, choice = step_aim(aim, raised, np.array([1.0, 0.0, 0.0]), lambda _line, _before: fruit, DT_S, CONFIG)
        if choice is not None:
            decided.append(choice)
    return aim, decided


def test_holding_still_on_a_fruit_decides_once_until_the_hand_is_let_down() -> None:
    aim, decided = play(CONFIG.aim_begin_s + CONFIG.aim_s + 0.2, Aim(), True, "a")
    assert decided == ["a"]
    aim, decided = play(3.0, aim, True, "b")
    assert decided == [], "the hand is still beside the head"
    aim, _ = play(2.0, aim, False, None)
    assert aim == Aim()
    _, decided = play(2.0, aim, True, "b")
    assert decided == ["b"]


def test_progress_begins_anew_with_another_fruit() -> None:
    aim, decided = play(CONFIG.aim_begin_s + 0.6, Aim(), True, "a")
    assert decided == [] and 0.5 < aim.progress(CONFIG) < 1.0
    aim, decided = play(0.1, aim, True, "b")
    assert decided == [] and aim.fruit == "b" and aim.progress(CONFIG) < 0.2


def test_pointing_at_nothing_for_as_long_says_so() -> None:
    assert play(2.0, Aim(), True, None)[1] == [""]


def test_a_hand_that_passes_the_head_decides_nothing() -> None:
    aim, decided = play(CONFIG.aim_begin_s - 0.05, Aim(), True, "a")
    assert decided == [] and aim.fruit is None
    assert play(1.0, aim, False, "a")[0] == Aim()


def test_one_bad_frame_does_not_end_the_aim() -> None:
    aim, _ = play(0.6, Aim(), True, "a")
    aim, _ = play(DT_S, aim, False, None)
    assert aim.fruit == "a"
    _, decided = play(0.6, aim, True, "a")
    assert decided == ["a"]


def test_the_direction_is_smoothed() -> None:
    aim, _ = play(1.0, Aim(), True, None)
    jump = np.array([0.0, 1.0, 0.0])
    seen: list[float] = []

    def look(line: np.ndarray, _before: str | None) -> None:
        seen.append(math.degrees(math.acos(float(line @ [1.0, 0.0, 0.0]))))

    aim = Aim(raised_s=0.5, direction=(1.0, 0.0, 0.0))
    for _ in range(30):
        aim, _ = step_aim(aim, True, jump, look, DT_S, CONFIG)  # type: ignore[arg-type]
    assert seen[0] < 25.0 and seen[-1] > 85.0 and seen == sorted(seen)
