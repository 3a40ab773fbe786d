"""Fruit: it hangs until it is cut, is held by both fingers only, and ends in the box or on the floor."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest

from robot_sim.commands import ArmTarget, RobotCommand
from robot_sim.config import AxisLimits, RobotConfig, ToolConfig
from robot_sim.plants import Fruit
from robot_sim.reach import hand_in_base
from robot_sim.state import RobotState
from robot_sim.urdf_parts_tools import GRIP_M
from robot_sim.world import World

FRAME_S = 1.0 / 30.0
GRIP_UNDER_TOP_M = 0.05
PICK = ArmTarget(45, 0, 135)


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
    """Drive, lift and reach, in the steps an operator's arm has, until the open gripper is round the fruit."""
    x, _, z = hand_in_base("right", PICK, GRIP_M, 0.0, 0.0, world.config)
    for _ in range(150):
        ahead = fruit.xyz_m[0] - world.state().base_x_m - x
        run(world, FRAME_S, drive_m_s=max(-0.3, min(0.3, 2.0 * ahead)) if abs(ahead) > 0.003 else 0.0)
    lift = fruit.xyz_m[2] + fruit.top_m - GRIP_UNDER_TOP_M - z
    run(world, 3.0, lift_m=lift)
    run(world, 1.0, right_arm=PICK)
    return PICK


@pytest.mark.parametrize("left", [ArmTarget(30, 0, 135), ArmTarget(15, 0, 120), ArmTarget(45, 0, 155)])
def test_a_cucumber_is_gripped_cut_and_dropped_into_the_box_under_it(world: World, left: ArmTarget) -> None:
    fruit = target_of(world)
    reach_for(world, fruit)
    run(world, 0.8, left_arm=left)
    assert world.state().fruits == {}
    assert run(world, 0.6, gripper_open=False).fruits == {fruit.name: "held"}
    run(world, 0.4, cutter_closed=True)
    assert run(world, 0.5, gripper_open=True).fruits == {fruit.name: "boxed"}
    # it stays there while the robot drives off and the arms come down
    run(world, 1.0, drive_m_s=0.3, right_arm=ArmTarget(0, 0, 90), left_arm=ArmTarget(0, 0, 105))
    assert run(world, 0.7).fruits == {fruit.name: "boxed"}


def test_a_cut_cucumber_is_carried_away(world: World) -> None:
    fruit = target_of(world)
    reach_for(world, fruit)
    run(world, 0.6, gripper_open=False)
    # not cut yet: the peduncle holds it against the pull of the arm
    run(world, 0.4, cutter_closed=True)
    away = run(world, 1.0, right_arm=ArmTarget(15, 0, 105))
    assert away.fruits == {fruit.name: "held"}
    assert math.dist(away.moved[fruit.name][:3], fruit.xyz_m) > 0.1


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
    # let go, it swings to rest
    state = run(world, 12.0, gripper_open=True)
    assert state.fruits == {}
    where = state.moved.get(fruit.name, fruit.xyz_m)
    assert math.dist(where[:3], fruit.xyz_m) < 0.01


def test_cutting_air_cuts_nothing(world: World) -> None:
    state = run(world, 1.0, cutter_closed=True)
    assert state.cutter_closed and state.fruits == {} and state.moved == {}


@pytest.mark.parametrize(("effort_n", "status"), [(30.0, "held"), (60.0, "held+damaged")])
def test_too_much_grip_bruises(effort_n: float, status: str) -> None:
    jaw = AxisLimits(lower=0.0, upper=0.06, speed=0.2, acceleration=2.0, effort=effort_n)
    # the peduncle bears it, so that it is the grip which is judged
    world = World(RobotConfig(tool=ToolConfig(jaw=jaw, bruise_n=50.0, peduncle_n=500.0)), seed=0)
    fruit = target_of(world)
    reach_for(world, fruit)
    assert run(world, 1.0, gripper_open=False).fruits == {fruit.name: status}
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
