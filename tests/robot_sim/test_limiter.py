"""The limiter: nothing it is told can push a set-point beyond range, speed or acceleration."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robot_sim.actuators import JOINT_INDEX, JOINTS, axes
from robot_sim.commands import ArmTarget, Liquid, RobotCommand, stop_command
from robot_sim.config import RobotConfig
from robot_sim.limiter import Setpoints, home_setpoints, latch_estop, limit
from robot_sim.reasons import RobotReason

CONFIG = RobotConfig()
DT = 1.0 / 240.0
NEAR_TRUNK_DEG = -5.0
"""An arm that leans inwards by more than this may come too near to the trunk."""
any_float = st.floats(allow_nan=True, allow_infinity=True)
wild = st.one_of(any_float, st.floats(-200.0, 400.0))
arm_targets = st.one_of(st.none(), st.builds(ArmTarget, wild, wild, wild))
commands = st.builds(
    RobotCommand,
    t_ns=st.just(0),
    drive_m_s=st.one_of(any_float, st.floats(-1.0, 1.0)),
    turn_rad_s=st.one_of(any_float, st.floats(-1.0, 1.0)),
    right_arm=arm_targets,
    left_arm=arm_targets,
    rear_arm=arm_targets,
    lift_m=st.one_of(st.none(), st.floats(-1.0, 1.0)),
    disc_rad=st.one_of(st.none(), st.floats(-7.0, 7.0)),
    gripper_open=st.one_of(st.none(), st.booleans()),
    cutter_closed=st.one_of(st.none(), st.booleans()),
    spray_on=st.booleans(),
    liquid=st.one_of(st.none(), st.sampled_from(Liquid)),
    head_camera_sweep=st.booleans(),
    stand_still=st.booleans(),
)


def run(setpoints: Setpoints, command: RobotCommand, ticks: int) -> tuple[Setpoints, set[str]]:
    seen: set[str] = set()
    for _ in range(ticks):
        setpoints, reasons = limit(setpoints, command, DT, CONFIG)
        seen |= set(reasons)
    return setpoints, seen


def joint(setpoints: Setpoints, name: str) -> float:
    return setpoints.position[JOINT_INDEX[name]]


@settings(max_examples=60)
@given(st.lists(st.tuples(commands, st.integers(1, 40), st.booleans()), min_size=1, max_size=6))
def test_every_tick_stays_inside_range_speed_and_acceleration(script: list[tuple[RobotCommand, int, bool]]) -> None:
    now = home_setpoints(CONFIG)
    chassis = CONFIG.chassis
    for command, ticks, estop in script:
        now = latch_estop(now, estop)
        for _ in range(ticks):
            before = now
            now, _ = limit(before, command, DT, CONFIG)
            for axis, p, v, p0, v0 in zip(
                axes(CONFIG), now.position, now.velocity, before.position, before.velocity, strict=True
            ):
                a = axis.limits
                assert a.lower - 1e-12 <= p <= a.upper + 1e-12, axis.name
                assert abs(v) <= a.speed + 1e-9, axis.name
                assert abs(p - p0) <= a.speed * DT + 1e-12, axis.name
                assert abs(v - v0) <= a.acceleration * DT + 1e-9, axis.name
            assert abs(now.drive_m_s) <= chassis.drive_m_s and abs(now.turn_rad_s) <= chassis.turn_rad_s
            braking = chassis.estop_m_s2 if estop else chassis.stop_m_s2
            assert abs(now.drive_m_s - before.drive_m_s) <= braking * DT + 1e-12
            assert not (now.spray_on and estop)


@settings(max_examples=60)
@given(st.floats(-15.0, 115.0), st.floats(-8.0, 98.0), st.floats(90.0, 180.0))
def test_a_target_in_range_is_reached_exactly_or_held_before_the_trunk_and_kept(
    c1: float, c2: float, elbow: float
) -> None:
    command = RobotCommand(t_ns=0, right_arm=ArmTarget(c1, c2, elbow))
    now, reasons = run(home_setpoints(CONFIG), command, 480)
    reached = (joint(now, "right_c1"), joint(now, "right_c2"), joint(now, "right_elbow"))
    asked = (math.radians(c1), math.radians(c2), math.radians(180 - elbow))
    assert (reached == pytest.approx(asked, abs=1e-12)) == (RobotReason.BODY_DISTANCE not in reasons)
    assert RobotReason.BODY_DISTANCE not in reasons or c2 < NEAR_TRUNK_DEG
    assert set(now.velocity) == {0.0}
    assert RobotReason.JOINT_LIMIT not in reasons


def test_a_target_out_of_range_is_clamped_and_says_so() -> None:
    now, reasons = run(home_setpoints(CONFIG), RobotCommand(t_ns=0, left_arm=ArmTarget(400.0, 0.0, 180.0)), 600)
    assert joint(now, "left_c1") == CONFIG.arm.c1.upper
    assert {RobotReason.JOINT_LIMIT, RobotReason.JOINT_SPEED} <= reasons


def test_not_a_number_is_refused_and_the_arm_keeps_its_goal() -> None:
    start, _ = run(home_setpoints(CONFIG), RobotCommand(t_ns=0, right_arm=ArmTarget(30.0, 10.0, 150.0)), 300)
    bad = RobotCommand(t_ns=0, drive_m_s=math.nan, lift_m=math.inf, right_arm=ArmTarget(math.nan, 50.0, 90.0))
    now, reasons = run(start, bad, 240)
    assert now.position == start.position and now.drive_m_s == 0.0
    assert reasons == {RobotReason.NOT_A_NUMBER}


def test_none_lets_a_joint_finish_and_stop_does_not() -> None:
    moving, _ = run(home_setpoints(CONFIG), RobotCommand(t_ns=0, lift_m=0.35), 60)
    finished, _ = run(moving, RobotCommand(t_ns=0), 1200)
    assert joint(finished, "lift") == pytest.approx(0.35)
    stopped, _ = run(moving, stop_command(0, "stop.body"), 240)
    assert joint(stopped, "lift") < 0.20
    resumed, _ = run(stopped, RobotCommand(t_ns=0), 240)
    assert resumed.position == stopped.position


def test_emergency_stop_brakes_latches_and_does_not_resume_by_itself() -> None:
    command = RobotCommand(t_ns=0, drive_m_s=0.5, right_arm=ArmTarget(90.0, 0.0, 180.0), spray_on=True)
    moving, _ = run(home_setpoints(CONFIG), command, 100)
    assert moving.drive_m_s > 0.3 and moving.spray_on
    stopped, reasons = run(latch_estop(moving, True), command, 120)
    assert stopped.drive_m_s == 0.0 and not stopped.spray_on and set(stopped.velocity) == {0.0}
    assert RobotReason.ESTOP in reasons
    assert joint(stopped, "right_c1") < math.radians(80)
    released, _ = run(latch_estop(stopped, False), RobotCommand(t_ns=0), 240)
    assert released.position == stopped.position


def test_arms_cutter_and_spray_are_locked_while_the_disc_turns() -> None:
    command = RobotCommand(
        t_ns=0, disc_rad=math.pi, right_arm=ArmTarget(60.0, 0.0, 120.0), cutter_closed=True, spray_on=True
    )
    turning, reasons = run(home_setpoints(CONFIG), command, 240)
    assert RobotReason.DISC_TURNING in reasons
    assert joint(turning, "right_c1") == 0.0 and joint(turning, "cutter") == 0.0
    assert not turning.spray_on and not turning.cutter_closed
    done, _ = run(turning, command, 720)
    assert joint(done, "disc") == math.pi and done.spray_on and joint(done, "right_c1") == pytest.approx(math.pi / 3)


def test_a_half_turn_of_the_disc_takes_about_two_seconds() -> None:
    now, ticks = home_setpoints(CONFIG), 0
    while joint(now, "disc") < math.pi:
        now, _ = limit(now, RobotCommand(t_ns=0, disc_rad=math.pi), DT, CONFIG)
        ticks += 1
    assert ticks * DT == pytest.approx(2.0, abs=0.1)


def test_the_head_camera_sweeps_between_its_limits_and_stops_where_it_is() -> None:
    now, seen = home_setpoints(CONFIG), []
    for _ in range(240 * 12):
        now, _ = limit(now, RobotCommand(t_ns=0, head_camera_sweep=True), DT, CONFIG)
        seen.append(joint(now, "head_pan"))
    pan = CONFIG.body.head_pan
    assert max(seen) == pan.upper and min(seen) == pan.lower
    halted, _ = run(now, RobotCommand(t_ns=0), 240)
    assert halted.velocity[JOINT_INDEX["head_pan"]] == 0.0


def test_speeds_are_clamped_with_a_reason_of_their_own() -> None:
    now, reasons = run(home_setpoints(CONFIG), RobotCommand(t_ns=0, drive_m_s=9.0, turn_rad_s=-9.0), 480)
    assert (now.drive_m_s, now.turn_rad_s) == (CONFIG.chassis.drive_m_s, -CONFIG.chassis.turn_rad_s)
    assert {RobotReason.CHASSIS_SPEED, RobotReason.CHASSIS_ACCELERATION} <= reasons


def test_home_is_inside_the_limits_of_any_configuration() -> None:
    narrow = CONFIG.body.lift.model_copy(update={"upper": 0.05})
    config = replace_lift(narrow)
    assert home_setpoints(config).position[JOINT_INDEX["lift"]] == 0.05
    assert len(home_setpoints(config).position) == len(JOINTS)
    assert replace(home_setpoints(config), estop=True).estop


def replace_lift(limits: object) -> RobotConfig:
    return CONFIG.model_copy(update={"body": CONFIG.body.model_copy(update={"lift": limits})})
