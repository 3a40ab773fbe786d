"""The simulated robot: repeatable, true to its set-points, straight on its tracks, stopped by the emergency stop."""

from __future__ import annotations

import gc
import math
import subprocess
import sys
from collections.abc import Iterator

import numpy as np
import pytest

from robot_sim.commands import ArmTarget, RobotCommand, stop_command
from robot_sim.config import GreenhouseConfig, RobotConfig
from robot_sim.errors import RobotError
from robot_sim.reasons import RobotReason
from robot_sim.state import RobotState
from robot_sim.world import World

FRAME_S = 1.0 / 30.0


@pytest.fixture(scope="module")
def shared() -> Iterator[World]:
    world = World(seed=1)
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


def script(world: World) -> list[RobotState]:
    states = [run(world, 0.5, drive_m_s=0.3, turn_rad_s=0.2, right_arm=ArmTarget(60, 20, 120))]
    states += [run(world, 0.5, disc_rad=1.0, lift_m=0.3, head_camera_sweep=True)]
    states += [run(world, 0.5, left_arm=ArmTarget(80, 30, 90), gripper_open=False, cutter_closed=True)]
    return states


def test_same_seed_and_commands_give_bit_equal_states() -> None:
    runs = []
    for _ in range(2):
        world = World(seed=7)
        first = script(world)
        world.reset()
        runs += [first, script(world)]
        world.close()
    assert runs[0] == runs[1] == runs[2] == runs[3]


def test_looking_does_not_disturb_the_physics(world: World) -> None:
    blind = script(world)
    world.reset()
    world.head_camera_rgb(32, 24)
    run(world, 0.0)
    seen = []
    for state in script(world):
        world.head_camera_rgb(32, 24)
        seen.append(state)
    assert seen == blind


def test_joints_follow_their_set_points() -> None:
    # no fruit in the way: this is about the servos
    world = World(RobotConfig(greenhouse=GreenhouseConfig(fruits_per_plant=0)))
    targets = [ArmTarget(75, 30, 120), ArmTarget(15, 0, 180), ArmTarget(90, 60, 90), ArmTarget(0, 90, 150)]
    moving, resting = 0.0, 0.0
    for target in targets:
        for frame in range(45):
            command = RobotCommand(t_ns=0, right_arm=target, left_arm=target, rear_arm=target)
            state = world.step(command, FRAME_S)
            error = max(
                abs(state.joint_rad[name] - q)
                for name, q in state.target_rad.items()
                if name.startswith(("right_", "left_", "rear_", "disc"))
            )
            moving = max(moving, error)
            if frame >= 42:
                resting = max(resting, error)
    world.close()
    assert math.degrees(moving) < 3.0
    assert math.degrees(resting) < 0.8
    assert state.joint_rad["right_c2"] == pytest.approx(math.radians(90), abs=math.radians(0.8))


def test_two_metres_straight(world: World) -> None:
    start = world.state()
    state = start
    while state.base_x_m - start.base_x_m < 2.0:
        state = run(world, FRAME_S, drive_m_s=0.5)
        assert state.sim_time_s < 8.0
    state = run(world, 1.5)
    assert abs(state.base_y_m - start.base_y_m) < 0.02
    assert abs(state.drive_m_s) < 1e-3


@pytest.mark.parametrize("turn_rad_s", [0.8, -0.5])
def test_a_turn_on_the_spot(world: World, turn_rad_s: float) -> None:
    start = run(world, 0.5, right_arm=ArmTarget(75, 15, 150))
    turned, state = 0.0, start
    while abs(turned) < 2 * math.pi:
        before = state
        state = run(world, FRAME_S, turn_rad_s=turn_rad_s)
        turned += math.remainder(state.base_yaw_rad - before.base_yaw_rad, 2 * math.pi)
        assert state.sim_time_s < 20.0
    state = run(world, 1.5)
    assert math.hypot(state.base_x_m - start.base_x_m, state.base_y_m - start.base_y_m) < 0.05
    assert state.turn_rad_s == pytest.approx(0.0, abs=1e-3)


def test_speeds_are_those_commanded(world: World) -> None:
    assert run(world, 1.5, drive_m_s=0.4).drive_m_s == pytest.approx(0.4, abs=0.02)
    world.reset()
    before = run(world, 1.0, turn_rad_s=0.6)
    after = run(world, 2.0, turn_rad_s=0.6)
    turned = math.remainder(after.base_yaw_rad - before.base_yaw_rad, 2 * math.pi)
    assert turned / 2.0 == pytest.approx(0.6, rel=0.05)


def test_the_chassis_stands_while_the_upper_body_works(world: World) -> None:
    start = world.state()
    state = run(world, 2.5, disc_rad=math.pi)
    state = run(world, 1.0, rear_arm=ArmTarget(80, 20, 150), spray_on=True)
    assert state.joint_rad["disc"] == pytest.approx(math.pi, abs=0.01)
    assert math.hypot(state.base_x_m - start.base_x_m, state.base_y_m - start.base_y_m) < 0.005
    assert abs(state.base_yaw_rad - start.base_yaw_rad) < math.radians(1.0)


def test_driving_into_a_gutter_stops_there_and_backs_out(world: World) -> None:
    run(world, 2.2, turn_rad_s=0.8)
    touched = False
    for _ in range(120):
        state = world.step(RobotCommand(t_ns=0, drive_m_s=0.5), FRAME_S)
        touched = touched or RobotReason.CONTACT in state.reasons
    offset = world.config.greenhouse.row_offset_m
    assert touched
    assert 0.05 < state.base_y_m < offset - 0.1
    assert math.hypot(state.drive_m_s, state.turn_rad_s) < 0.15
    back = run(world, 2.0, drive_m_s=-0.4)
    assert back.base_y_m < state.base_y_m - 0.3


def test_a_reset_leaves_nothing_behind(world: World) -> None:
    """PyBullet keeps every list that it is given; the looks alone are ten thousand."""
    gc.collect()
    before = len(gc.get_objects())
    for _ in range(3):
        world.reset()
    gc.collect()
    assert len(gc.get_objects()) - before < 1000


def test_emergency_stop_stops_everything_until_reset(world: World) -> None:
    run(world, 1.0, drive_m_s=0.5, right_arm=ArmTarget(90, 0, 180))
    assert world.estop().estop
    run(world, 0.5, drive_m_s=0.5, right_arm=ArmTarget(90, 0, 180))
    held = world.state()
    state = run(world, 0.5, drive_m_s=0.5, right_arm=ArmTarget(0, 0, 180), spray_on=True)
    assert state.estop and not state.spray_on and abs(state.drive_m_s) < 1e-3
    assert state.base_x_m == pytest.approx(held.base_x_m, abs=1e-3)
    assert state.target_rad == held.target_rad
    assert RobotReason.ESTOP in state.reasons
    assert not world.estop_reset().estop
    assert run(world, 1.0, drive_m_s=0.3).drive_m_s == pytest.approx(0.3, abs=0.03)


@pytest.mark.parametrize("motion", [{"drive_m_s": 0.3}, {"drive_m_s": -0.3}, {"turn_rad_s": 0.8}])
def test_emergency_stop_brings_the_tracks_to_rest_within_55_ms(world: World, motion: dict[str, float]) -> None:
    run(world, 1.0, **motion)
    world.estop()
    state = world.step(RobotCommand(t_ns=0, **motion), 0.055)  # type: ignore[arg-type]
    assert abs(state.drive_m_s) < 0.01
    assert abs(state.turn_rad_s) < 0.01


def test_emergency_stop_from_full_speed_with_the_lift_up_hardly_tilts_the_robot(world: World) -> None:
    ahead = ArmTarget(80, 0, 170)
    most = world.config.chassis.drive_m_s
    run(world, 6.0, lift_m=world.config.body.lift.upper, right_arm=ahead, left_arm=ahead)
    moving = run(world, 1.5, drive_m_s=most, right_arm=ahead, left_arm=ahead)
    assert moving.drive_m_s == pytest.approx(most, abs=0.02)
    world.estop()
    tilts_rad = []
    for _ in range(60):
        world.step(RobotCommand(t_ns=0), FRAME_S / 8)
        R = world._robot.link_pose("lift_link").R
        tilts_rad.append(math.acos(min(1.0, R[2, 2])))
    assert math.degrees(max(tilts_rad)) < 0.2


def test_a_stop_command_stops_a_moving_lift_and_a_plain_hold_does_not(world: World) -> None:
    run(world, 0.5, lift_m=0.4)
    world.step(stop_command(0, "stop.body"), FRAME_S)
    stopped = run(world, 1.0)
    assert stopped.joint_rad["lift"] < 0.25
    world.step(RobotCommand(t_ns=0, lift_m=0.4), FRAME_S)
    assert run(world, 3.0).joint_rad["lift"] == pytest.approx(0.4, abs=1e-3)


def test_time_that_is_no_multiple_of_a_tick_is_carried(world: World) -> None:
    total = 0.0
    for k in range(200):
        dt = 0.0011 + 0.0003 * (k % 7)
        total += dt
        state = world.step(RobotCommand(t_ns=0), dt)
        assert 0.0 <= total - state.sim_time_s < 1.0 / 240 + 1e-6
    world.reset()
    for _ in range(30):
        state = world.step(RobotCommand(t_ns=0), FRAME_S)
    assert state.sim_time_s == 1.0


@pytest.mark.parametrize("dt_s", [-0.1, math.nan, math.inf])
def test_an_impossible_time_step_is_refused(world: World, dt_s: float) -> None:
    with pytest.raises(RobotError, match="finite number of seconds"):
        world.step(RobotCommand(t_ns=0), dt_s)


def test_not_a_number_never_reaches_the_motors(world: World) -> None:
    state = run(world, 0.3, drive_m_s=math.nan, disc_rad=math.inf, left_arm=ArmTarget(math.nan, 0.0, 90.0))
    assert RobotReason.NOT_A_NUMBER in state.reasons
    assert all(math.isfinite(q) for q in (*state.joint_rad.values(), state.base_x_m, state.drive_m_s))


def test_the_head_camera_sees_the_crop(world: World) -> None:
    image = world.head_camera_rgb(160, 120)
    assert image.shape == (120, 160, 3) and image.dtype == np.uint8
    r, g, b = (image[..., k].astype(int) for k in range(3))
    assert ((g > r + 20) & (g > b + 20)).mean() > 0.05
    turned = run(world, 3.0, head_camera_sweep=True)
    assert abs(turned.joint_rad["head_pan"]) > 0.5
    assert (world.head_camera_rgb(160, 120) != image).any()


def test_importing_the_pure_parts_never_loads_pybullet() -> None:
    code = (
        "import sys, robot_sim.urdf, robot_sim.limiter, robot_sim.greenhouse, robot_sim.head_camera;"
        "sys.exit('pybullet' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
