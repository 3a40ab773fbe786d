"""What the robot refuses or reports, with reason codes and events, and never with an exception in the loop."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest

from robot_sim.commands import ArmTarget, Liquid, RobotCommand
from robot_sim.config import ClearanceConfig, RobotConfig, ServoConfig, SprayConfig
from robot_sim.events import RobotEventKind
from robot_sim.reasons import RobotReason
from robot_sim.scenario import PICK_POSE, standing_place
from robot_sim.servo import SERVOS, driven
from robot_sim.world import World

FRAME_S = 1.0 / 30.0


@pytest.fixture(scope="module")
def shared() -> Iterator[World]:
    world = World(RobotConfig(spray=SprayConfig(tank_l=0.05)), seed=0)
    yield world
    world.close()


@pytest.fixture
def world(shared: World) -> World:
    shared.reset()
    return shared


def run(world: World, seconds: float, **command: object) -> tuple[set[str], set[str]]:
    """Reason codes and kinds of events of a stretch of time."""
    reasons: set[str] = set()
    kinds: set[str] = set()
    for _ in range(round(seconds / FRAME_S)):
        reasons |= set(world.step(RobotCommand(t_ns=0, **command), FRAME_S).reasons)  # type: ignore[arg-type]
        kinds |= {str(event.kind) for event in world.events}
    return reasons, kinds


def test_commands_outside_the_limits_are_clamped_with_a_reason(world: World) -> None:
    reasons, _ = run(world, 1.5, right_arm=ArmTarget(400, 0, 180), lift_m=9.0, drive_m_s=99.0, turn_rad_s=math.nan)
    assert {RobotReason.JOINT_LIMIT, RobotReason.CHASSIS_SPEED, RobotReason.NOT_A_NUMBER} <= reasons
    state = world.state()
    assert state.joint_rad["right_c1"] <= world.config.arm.c1.upper + 0.01
    assert abs(state.drive_m_s) <= world.config.chassis.drive_m_s + 0.02


def test_an_empty_tank_gives_a_reason_once_an_event_and_nothing_more(world: World) -> None:
    reasons, kinds = run(world, 3.0, spray_on=True, liquid=Liquid.NUTRIENT)
    assert RobotReason.TANK_EMPTY in reasons and RobotEventKind.TANK_EMPTY in kinds
    assert world.metrics().sprayed_l["nutrient"] == pytest.approx(0.05)
    assert not world.state().spray_on
    _, kinds = run(world, 0.5, spray_on=True)
    assert kinds == set()


def test_picking_with_an_open_gripper_says_that_the_fruit_falls(world: World) -> None:
    fruit = next(f for f in world.fruits if f.crop == "cucumber" and 0.2 < f.xyz_m[0] < 0.8)
    x_m, lift_m = standing_place(fruit, world.config)
    for _ in range(150):
        run(world, FRAME_S, drive_m_s=min(0.3, max(-0.3, 2.0 * (x_m - world.state().base_x_m))), lift_m=lift_m)
    run(world, 1.0, right_arm=PICK_POSE)
    reasons, kinds = run(world, 2.0, cutter_closed=True)
    assert RobotReason.NOT_HELD in reasons
    assert {RobotEventKind.CUT, RobotEventKind.DROPPED} <= kinds
    assert (world.metrics().cut, world.metrics().dropped, world.metrics().picked) == (1, 1, 0)


def test_cutting_air_says_so(world: World) -> None:
    reasons, kinds = run(world, 0.6, cutter_closed=True)
    assert RobotReason.NOTHING_CUT in reasons and kinds == set()


def test_driving_into_a_gutter_is_one_event(world: World) -> None:
    run(world, 2.2, turn_rad_s=0.8)
    reasons, kinds = run(world, 3.0, drive_m_s=0.5)
    assert RobotReason.CONTACT in reasons and RobotEventKind.OBSTACLE in kinds
    assert world.metrics().obstacle_contacts >= 1
    assert world.state().base_y_m < world.config.greenhouse.row_offset_m - 0.1


def test_wrong_liquid_is_counted() -> None:
    world = World(RobotConfig(), seed=0)
    assert world.diseased and all(name.split("_")[0] in ("cucumber", "tomato") for name in world.diseased)
    assert world.metrics().wrong_liquid == 0.0
    run(world, 3.5, disc_rad=math.pi)
    run(world, 1.0, spray_on=True, liquid=Liquid.PESTICIDE, rear_arm=ArmTarget(0, 0, 100))
    pesticide = world.metrics()
    assert pesticide.sprayed_l["pesticide"] > 0.0
    assert 0.0 <= pesticide.wrong_liquid <= 1.0 - pesticide.overspray + 1e-9
    world.reset()
    run(world, 3.5, disc_rad=math.pi)
    run(world, 1.0, spray_on=True, liquid=Liquid.WATER, rear_arm=ArmTarget(0, 0, 100))
    water = world.metrics()
    # what is right for a leaf with mildew is wrong for a healthy one, and the other way round
    assert water.wrong_liquid + pesticide.wrong_liquid == pytest.approx(1.0 - water.overspray, abs=0.08)
    world.close()


def test_arms_that_touch_are_an_event_and_pass_a_snapshot() -> None:
    # the limiter's distances as small as they go: the world must still see it
    world = World(RobotConfig(clearance=ClearanceConfig(arm_gap_m=0.0, body_gap_m=0.0)), seed=0)
    world._setpoints = world._setpoints.__class__(
        position=tuple(
            {5: math.radians(30), 6: -0.4, 7: 1.0, 2: math.radians(30), 3: -0.4, 4: 1.0}.get(i, q)
            for i, q in enumerate(world._setpoints.position)
        ),
        velocity=world._setpoints.velocity,
        goal=world._setpoints.goal,
    )
    reasons, kinds = run(world, 0.5)
    assert RobotReason.ARM_CONTACT in reasons and RobotEventKind.ARM_CONTACT in kinds
    kept, before = world.snapshot(), world.metrics()
    assert before.arm_contacts > 0
    run(world, 0.3, drive_m_s=0.3)
    world.restore(kept)
    assert world.metrics() == before
    world.close()


def test_backlash_follows_the_play_operator_and_whole_degrees_round() -> None:
    config = ServoConfig(whole_degrees=True, backlash_rad=0.02)
    i = SERVOS[0]
    out = (0.0,) * 15

    def at(q: float) -> float:
        nonlocal out
        out = driven(out, tuple(q if k == i else 0.3 for k in range(15)), config)
        return out[i]

    assert at(math.radians(10.4)) == pytest.approx(math.radians(10) - 0.01)
    assert at(math.radians(9.6)) == pytest.approx(math.radians(10) - 0.01)
    assert at(math.radians(9.4)) == pytest.approx(math.radians(10) - 0.01), "still inside the gap"
    assert at(math.radians(5.0)) == pytest.approx(math.radians(5) + 0.01)
    assert out[0] == 0.3, "lift and disc are exact"


def test_a_coarse_servo_is_off_by_half_a_degree_and_its_play() -> None:
    servo = ServoConfig(whole_degrees=True, backlash_rad=0.01)
    world = World(RobotConfig(servo=servo), seed=0)
    run(world, 2.0, rear_arm=ArmTarget(30.4, 0, 140.4))
    state = world.state()
    for joint in ("rear_c1", "rear_elbow"):
        error = abs(state.joint_rad[joint] - state.target_rad[joint])
        assert 1e-4 < error < math.radians(0.5) + 0.5 * servo.backlash_rad + math.radians(0.1), joint
    world.close()
