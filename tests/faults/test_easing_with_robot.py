"""No jump on engaging: kernel and PyBullet together, wherever the robot was left."""

from collections.abc import Iterator
from math import degrees

import numpy as np
import pytest
from scripted import Rig, engaged, rig
from stick_figure import FISTS, HANGING, OPEN_HANDS, Person, raised

from robot_sim.arm_angles import ARM_AXES
from robot_sim.commands import ARM_NAMES, ArmTarget
from robot_sim.pick.plan import Scenery
from robot_sim.world import World
from teleop.assist.task import RobotView
from teleop.inputs import Inputs, RobotRequest
from teleop.intent_types import Mode
from teleop.pipeline import PipelineOutput

JOINTS = [f"{arm}_{axis}" for arm in ARM_NAMES for axis in ARM_AXES]
PICK = Person(legs_apart_deg=25)
EASE_DEG_S = 80.0
"""Steps of 15 degrees every 0.3 s, seen over any half second; the limiter alone allows 149 and 183."""


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    made = World()
    yield made
    made.close()


def play(r: Rig, world: World, person: Person, seconds: float, inputs: Inputs = Inputs()) -> list[PipelineOutput]:
    outs = []
    for i in range(round(seconds * 30)):
        r.robot = RobotView(world.state(), world.config, Scenery((), ()))
        outs.append(r.show(person, inputs if i == 0 else Inputs()))
        world.step(outs[-1].command, 1 / 30)
    return outs


def fastest_deg_s(r: Rig, world: World, person: Person, seconds: float, inputs: Inputs) -> float:
    """Largest mean speed of any arm set-point over half a second."""
    seen = []
    for i in range(round(seconds * 30)):
        play(r, world, person, 1 / 30, inputs if i == 0 else Inputs())
        seen.append([world.state().target_rad[name] for name in JOINTS])
    q = np.degrees(seen)
    return float(np.abs(q[15:] - q[:-15]).max() / 0.5)


@pytest.mark.parametrize("forgotten", [False, True])
def test_engaging_eases_in_from_where_the_arms_were_left(world: World, forgotten: bool) -> None:
    """By a request that an emergency stop cut short, or before another configuration made the kernel forget it."""
    world.reset()
    r = rig()
    play(r, world, PICK, 0.5)
    play(
        r,
        world,
        PICK,
        0.5,
        Inputs(request=RobotRequest(right_arm=ArmTarget(80, 0, 120), left_arm=ArmTarget(0, 70, 180))),
    )
    if forgotten:
        play(r, world, PICK, 1.5)
        r = rig()
        play(r, world, PICK, 0.5)
    else:
        world.estop()
        play(r, world, PICK, 0.5, Inputs(estop=True))
        world.estop_reset()
        play(r, world, PICK, 0.5, Inputs(estop_reset=True))
    left_at = [degrees(world.state().target_rad[f"right_{axis}"]) for axis in ARM_AXES]
    assert left_at[0] > 20
    assert fastest_deg_s(r, world, PICK, 3.0, Inputs(engage=True)) < EASE_DEG_S
    assert r.show(PICK).intent.mode is Mode.PICKING
    assert degrees(world.state().target_rad["right_c1"]) == pytest.approx(0.0, abs=0.5), "it follows the hanging arm"


def test_a_disc_that_was_stopped_on_its_way_turns_on_with_the_arms_locked(world: World) -> None:
    world.reset()
    r = rig()
    spray = Person()
    play(r, world, spray, 0.5)
    play(r, world, spray, 1.0, Inputs(engage=True))
    world.estop()
    play(r, world, spray, 0.5, Inputs(estop=True))
    stopped_at = world.state().target_rad["disc"]
    assert 0.3 < stopped_at < 2.8
    world.estop_reset()
    play(r, world, spray, 0.5, Inputs(estop_reset=True))
    outs = play(r, world, spray, 4.0, Inputs(engage=True))
    turning = [out for out in outs if "hold.disc_turning" in out.command.reasons]
    expected_s = (np.pi - stopped_at) / np.pi * r.pipeline.intent.mapping.disc_half_turn_s
    assert len(turning) / 30 == pytest.approx(expected_s, abs=0.1)
    assert world.state().target_rad["disc"] == pytest.approx(np.pi, abs=1e-6) and outs[-1].command.rear_arm is not None


def test_what_the_watchdog_stopped_does_not_spray_again_by_itself() -> None:
    person = Person(right=raised(forward_deg=60), left=HANGING, hands=FISTS)
    r = engaged(person=person)
    r.hold(person, 3.0)
    sprayed = person.but(hands=OPEN_HANDS)
    assert r.hold(sprayed, 0.5)[-1].command.spray_on
    out = r.show(sprayed, Inputs(interrupted=True))
    assert not out.command.spray_on and out.intent.mode is Mode.SPRAYING
    assert not any(out.command.spray_on for out in r.hold(sprayed, 1.0))
    r.hold(person, 0.5)
    assert r.hold(sprayed, 0.5)[-1].command.spray_on, "a fist that opens starts it"
