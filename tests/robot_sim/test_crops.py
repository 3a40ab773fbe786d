"""Fruit: it hangs until it is cut, is held by both fingers only, and ends in the box or on the floor."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest

from robot_sim.commands import ArmTarget, RobotCommand
from robot_sim.config import AxisLimits, RobotConfig, ToolConfig
from robot_sim.plants import Fruit
from robot_sim.state import RobotState
from robot_sim.urdf_parts_tools import GRIP_M
from robot_sim.world import World

FRAME_S = 1.0 / 30.0
GRIP_UNDER_TOP_M = 0.035


@pytest.fixture(scope="module")
def shared() -> Iterator[World]:
    world = World(seed=0)
    yield world
    world.close()


@pytest.fixture
def world(shared: World) -> World:
    shared.reset()
    return shared


def run(world: World, seconds: float, **command: object) -> RobotState:
    state = world.state()
    for _ in range(round(seconds / FRAME_S)):
        state = world.step(RobotCommand(t_ns=0, **command), FRAME_S)  # type: ignore[arg-type]
    return state


def target_of(world: World) -> Fruit:
    return next(f for f in world.fruits if f.crop == "cucumber" and f.xyz_m[0] > 0.3 and f.xyz_m[2] > 1.1)


def reach_for(world: World, fruit: Fruit) -> ArmTarget:
    """Drive, lift and reach until the open gripper is round the fruit; returns the arm's target."""
    arm, body = world.config.arm, world.config.body
    for _ in range(150):
        ahead = fruit.xyz_m[0] - world.state().base_x_m - arm.shoulder_offset_m
        run(world, FRAME_S, drive_m_s=max(-0.3, min(0.3, 2.0 * ahead)) if abs(ahead) > 0.003 else 0.0)
    # with c2 at zero the arm moves in one plane; the forearm stays level
    c1 = math.asin((fruit.xyz_m[1] - arm.forward_offset_m - arm.forearm_m - GRIP_M) / arm.upper_m)
    height = fruit.xyz_m[2] + fruit.top_m - GRIP_UNDER_TOP_M
    lift = height - (body.shoulder_height_m - arm.upper_m * math.cos(c1))
    run(world, 3.0, lift_m=lift, right_arm=ArmTarget(10, 0, 100))
    target = ArmTarget(math.degrees(c1), 0, 90 + math.degrees(c1))
    run(world, 1.0, right_arm=target)
    return target


def test_a_cucumber_is_gripped_cut_and_put_into_the_box(world: World) -> None:
    fruit = target_of(world)
    reach_for(world, fruit)
    assert world.state().fruits == {}
    assert run(world, 0.8, gripper_open=False).fruits == {fruit.name: "held"}
    # not cut yet: the peduncle holds it against the pull of the arm
    run(world, 0.5, cutter_closed=True)
    run(world, 0.3, cutter_closed=False)
    run(world, 0.8, right_arm=ArmTarget(20, 0, 110))
    away = run(world, 1.0, right_arm=ArmTarget(90, -25, 160))
    assert away.fruits == {fruit.name: "held"}
    assert math.dist(away.moved[fruit.name][:3], fruit.xyz_m) > 0.2
    run(world, 1.2, left_arm=ArmTarget(50, -25, 135))
    run(world, 1.0, gripper_open=True)
    state = run(world, 1.0, left_arm=ArmTarget(30, 0, 120))
    assert state.fruits[fruit.name] == "boxed"


def test_cutting_without_gripping_drops_it(world: World) -> None:
    fruit = target_of(world)
    reach_for(world, fruit)
    state = run(world, 2.0, cutter_closed=True)
    assert state.fruits == {fruit.name: "dropped"}
    assert 0.0 < state.moved[fruit.name][2] < 0.1


def test_an_uncut_fruit_stays_on_its_plant(world: World) -> None:
    fruit = target_of(world)
    reach_for(world, fruit)
    run(world, 0.8, gripper_open=False)
    run(world, 1.0, right_arm=ArmTarget(10, 0, 100))
    state = run(world, 3.0, gripper_open=True)
    assert state.fruits == {}
    where = state.moved.get(fruit.name, fruit.xyz_m)
    assert math.dist(where[:3], fruit.xyz_m) < 0.03


def test_cutting_air_cuts_nothing(world: World) -> None:
    state = run(world, 1.0, cutter_closed=True)
    assert state.cutter_closed and state.fruits == {} and state.moved == {}


def test_too_much_grip_bruises() -> None:
    jaw = AxisLimits(lower=0.0, upper=0.042, speed=0.2, acceleration=2.0, effort=150.0)
    world = World(RobotConfig(tool=ToolConfig(jaw=jaw)), seed=0)
    fruit = target_of(world)
    reach_for(world, fruit)
    assert run(world, 1.0, gripper_open=False).fruits == {fruit.name: "held+damaged"}
    world.close()


def test_every_moved_part_is_scenery(world: World) -> None:
    fruit = target_of(world)
    reach_for(world, fruit)
    state = run(world, 1.5, cutter_closed=True)
    names = {p.name for p in world.scenery()}
    assert set(state.moved) == {p.name for p in fruit.parts} <= names
    for pose in state.moved.values():
        assert math.hypot(*pose[3:]) == pytest.approx(1.0)


def test_an_arm_that_pushes_through_tears_fruit_off_and_is_not_blocked(world: World) -> None:
    target = ArmTarget(57.3, 24.3, 93.7)
    state = run(world, 2.0, left_arm=target, rear_arm=target)
    assert any(status.endswith("+damaged") for status in state.fruits.values())
    assert state.joint_rad["left_elbow"] == pytest.approx(state.target_rad["left_elbow"], abs=math.radians(0.8))


def test_no_fruit_is_lost_through_floor_or_box(world: World) -> None:
    for i in range(len(world.fruits)):
        world._crops.detach(i)
    state = run(world, 3.0)
    assert all(pose[2] > -0.01 for pose in state.moved.values())
    assert set(state.fruits.values()) <= {"dropped", "loose"}
