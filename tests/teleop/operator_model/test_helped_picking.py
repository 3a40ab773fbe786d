"""An operator who points at a fruit: where their arm goes, what they correct, when they confirm."""

from dataclasses import replace

import numpy as np
import pytest

from robot_sim.env import GreenhouseEnv
from robot_sim.scenario import load_scenario
from teleop.intent_types import ArmAngles, BodyAngles, Hands, Mode
from teleop.operator_model.body import FIST, arm_key, standing
from teleop.operator_model.console import ConsoleView
from teleop.operator_model.helped_picking import HelpedPicker, Stage, pointing
from teleop.operator_model.picking import ready_to_pick
from teleop.operator_model.traits import traits_of

UNREAD = BodyAngles(ArmAngles(None, None, None), ArmAngles(None, None, None), None, None)
FRUIT, OTHER = "cucumber_3_fruit_0", "cucumber_3_fruit_1"


@pytest.fixture(scope="module")
def mind() -> HelpedPicker:
    scenario, traits = load_scenario("pick_one"), traits_of(0, 0)
    with GreenhouseEnv(scenario) as env:
        scenery = {part.name: part for part in env.world.scenery()}
    return HelpedPicker(traits, FRUIT, scenario.robot, scenery, ready_to_pick(traits))


def view(aimed: str | None, picked: tuple[str, str] | None = None) -> ConsoleView:
    scenario = load_scenario("pick_one")
    with GreenhouseEnv(scenario) as env:
        robot = env.reset()[0].robot
    base = (robot.base_x_m, robot.base_y_m, robot.base_yaw_rad)
    return ConsoleView(
        0.0, Mode.PICKING, None, Hands(), UNREAD, {}, base, robot.joint_rad, {}, False, {}, aimed, picked
    )


@pytest.mark.parametrize("direction", [(0.9, 0.1, -0.42), (0.6, 0.6, -0.5), (0.6, -0.6, -0.5), (0.1, 0.1, -0.99)])
def test_both_bones_of_the_arm_lie_along_the_direction(direction: tuple[float, float, float]) -> None:
    forward, left, up = np.array(direction) / np.linalg.norm(direction)
    arm = arm_key(pointing(np.array(direction), 45.0), 1.0, 0.0)
    # the room's axes: x to the operator's right, y up, z away from the sensor, which they face
    along = np.array([-left, up, -forward])
    assert np.degrees(np.arccos(arm.upper @ along)) < 1.0
    assert np.degrees(np.arccos(arm.fore @ along)) < 11.0


def test_when_a_higher_fruit_lights_up_they_point_lower(mind: HelpedPicker) -> None:
    seen = view(None)
    body = standing(mind.posture, mind.traits.pace, 0)
    pointed = mind.think(seen, body, 1.0)
    assert pointed.stage is Stage.POINT and pointed.aim is not None
    later = pointed.think(view(OTHER), body, 9.0)
    assert later.aim is not None and later.aim[2] < pointed.aim[2] - 0.02
    assert later.posture.right.front_deg < pointed.posture.right.front_deg


def test_the_preview_of_another_fruit_is_not_confirmed(mind: HelpedPicker) -> None:
    body = standing(mind.posture, mind.traits.pace, 0)
    pointed = mind.think(view(None), body, 1.0)
    wrong = pointed.think(view(None, (OTHER, "preview")), body, 9.0)
    assert wrong.stage is Stage.LOOK and wrong.posture.left_curl < FIST
    right = pointed.think(view(None, (FRUIT, "preview")), body, 2.0)
    assert right.stage is Stage.LOWER and right.posture.left_curl < FIST
    fisted = right.think(view(None, (FRUIT, "preview")), replace(body), 9.0)
    assert fisted.stage is Stage.CONFIRM
    assert fisted.posture.left_curl == fisted.posture.right_curl == FIST
