"""An operator picks with help: body and hands in, through intent, kernel, limiter and the real physics."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from scripted import Rig, engaged
from stick_figure import BESIDE_HEAD, CROSSED, FISTS, HANGING, OPEN_HANDS, Arm, Person

from robot_sim.pick.plan import Scenery
from robot_sim.pick.run import STAGES, Stage
from robot_sim.pick.surroundings import hard
from robot_sim.stance import stance_of
from robot_sim.state import RobotState
from robot_sim.urdf_parts_arms import shoulder_pose
from robot_sim.world import World
from teleop.assist.task import PickTask, RobotView, TaskStatus
from teleop.config import TeleopConfig
from teleop.inputs import Inputs, PickAsk, RobotRequest
from teleop.intent_types import Event, Hand, Hands, Mode
from teleop.pipeline import PipelineOutput
from teleop.reasons import Reason

FRUIT = "cucumber_2_fruit_0"
PICKING = Person(legs_apart_deg=24.0, hands=OPEN_HANDS)
FISTED = PICKING.but(hands=FISTS)


@dataclass
class Show:
    """The scripted person before the real robot: every command goes into the physics, every report comes back."""

    rig: Rig
    world: World
    scenery: Scenery
    events: list[Event] = field(default_factory=list)
    state: RobotState = None  # type: ignore[assignment]

    def show(self, who: Person | None, inputs: Inputs = Inputs()) -> PipelineOutput:
        self.rig.robot = RobotView(self.state, self.world.config, self.scenery)
        output = self.rig.show(who, inputs)
        self.events += output.events
        self.state = self.world.step(output.command, 1 / 30)
        return output

    def hold(self, who: Person | None, seconds: float) -> list[PipelineOutput]:
        return [self.show(who) for _ in range(round(30 * seconds))]

    def until(self, who: Person, stage: Stage, seconds: float = 12.0) -> None:
        for _ in range(round(30 * seconds)):
            if self.task.stage is stage:
                return
            self.show(who)
        raise AssertionError(f"not in {stage}: {self.task}")

    @property
    def task(self) -> PickTask:
        task = self.rig.state.kernel.assist.task
        assert task is not None
        return task

    @property
    def told(self) -> list[str]:
        return [event.reason for event in self.events if event.kind == "assist"]


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    made = World()
    yield made
    made.close()


@pytest.fixture
def show(world: World) -> Show:
    state = world.reset()
    rig = engaged(person=PICKING)
    begun = Show(rig, world, Scenery(hard(world.scenery()), world.fruits), state=state)
    begun.hold(PICKING, 0.3)
    assert rig.state.intent.mode is Mode.PICKING
    return begun


def pointing_at(name: str, show: Show) -> Arm:
    """The operator's arm along the line from the robot's shoulder to a fruit."""
    fruit = next(f for f in show.world.fruits if f.name == name)
    away = stance_of(show.state).to_disc(np.array(fruit.xyz_m), show.world.config)
    forward, left, up = away - np.array(shoulder_pose("right", show.world.config)[0])
    return Arm((forward, -left, up), (forward, -left, up))


def previewed(show: Show, name: str = FRUIT) -> Show:
    """The operator has pointed, and let the hand down again."""
    show.hold(PICKING.but(left=BESIDE_HEAD, right=pointing_at(name, show)), 1.6)
    show.hold(PICKING, 0.3)
    return show


def started(show: Show) -> Show:
    previewed(show)
    show.hold(FISTED, 0.4)
    assert show.task.status is TaskStatus.RUNNING
    return show


def test_pointing_opens_a_preview_the_left_fist_confirms_and_the_fruit_ends_in_the_box(show: Show) -> None:
    before = dict(show.state.joint_rad)
    previewed(show)
    assert (show.task.fruit, show.task.status) == (FRUIT, TaskStatus.PREVIEW)
    for arm in ("right", "left"):
        for axis in ("c1", "c2", "elbow"):
            assert show.state.joint_rad[f"{arm}_{axis}"] == pytest.approx(before[f"{arm}_{axis}"], abs=0.05)
    # the left fist confirms and does not cut; nothing moves while the right hand is open
    waiting = show.hold(PICKING.but(hands=Hands(Hand.OPEN, Hand.FIST, 1.0, 1.0)), 0.6)
    assert Reason.ASSIST_CLOSE_HANDS in waiting[-1].command.reasons
    assert not any(o.command.cutter_closed for o in waiting) and not show.state.cutter_closed
    for _ in range(600):
        show.show(FISTED)
        if not show.task.active:
            break
    assert show.task.status is TaskStatus.SUCCEEDED, show.task.detail
    assert show.state.fruits == {FRUIT: "boxed"}
    assert show.told == ["assist.preview", *(f"assist.{s}" for s in STAGES), Reason.ASSIST_DONE]
    metrics = show.world.metrics()
    assert (metrics.picked, metrics.damaged, metrics.dropped, metrics.arm_contacts) == (1, 0, 0, 0)
    assert show.rig.state.intent.mode is Mode.PICKING, "the operator goes on by hand"


def test_afterwards_arms_ease_in_from_where_they_are_and_tools_wait_for_their_hands(show: Show) -> None:
    started(show)
    for _ in range(600):
        show.show(FISTED)
        if not show.task.active:
            break
    assert show.task.status is TaskStatus.SUCCEEDED
    after = show.hold(FISTED, 0.5)
    assert Reason.HAND_NOT_CHANGED in after[-1].command.reasons and Reason.EASE_IN in after[-1].command.reasons
    assert show.state.gripper_open and not show.state.cutter_closed, "closed hands do not close them by themselves"
    lag = max(
        abs(b.joint_rad[j] - a.joint_rad[j])
        for a, b in zip([show.state], [show.world.state()], strict=True)
        for j in a.joint_rad
    )
    assert lag < 1e-9


OPENED = {"right": Hands(Hand.OPEN, Hand.FIST, 1.0, 1.0), "left": Hands(Hand.FIST, Hand.OPEN, 1.0, 1.0)}


@pytest.mark.parametrize(
    ("who", "reason"),
    [
        (PICKING.but(hands=OPENED["right"]), Reason.ASSIST_HAND_OPENED),
        (PICKING.but(hands=OPENED["left"]), Reason.ASSIST_HAND_OPENED),
        (FISTED.but(right=CROSSED, left=CROSSED), Reason.BODY_STOP),
        (None, Reason.TRACKING_LOST),
        (FISTED.but(legs_apart_deg=2.0), Reason.ASSIST_LEFT),
    ],
    ids=["right opens", "left opens", "body stop", "lost", "legs together"],
)
def test_the_robot_stands_still_as_soon_as_the_operator_takes_over(
    show: Show, who: Person | None, reason: Reason
) -> None:
    started(show)
    show.until(FISTED, Stage.APPROACH)
    show.hold(FISTED, 0.5)
    for _ in range(60):
        show.show(who)
        if not show.task.active:
            break
    assert (show.task.status, show.task.reason) == (TaskStatus.TAKEN_OVER, reason)
    show.hold(who, 0.3)
    at = {j: q for j, q in show.state.joint_rad.items() if j.startswith(("right_", "left_"))}
    # hands show nothing new, so what the operator's arms say is all that may move the robot's now
    show.hold(None, 0.2)
    moved = max(abs(show.state.joint_rad[j] - q) for j, q in at.items())
    assert moved < 0.25
    assert reason in show.told


def test_stepping_aside_takes_over(show: Show) -> None:
    started(show)
    for x in np.linspace(0.0, 0.6, 20):
        show.show(FISTED.but(x=float(x)))
    assert (show.task.status, show.task.reason) == (TaskStatus.TAKEN_OVER, Reason.ASSIST_LEFT)


def test_a_held_fruit_stays_in_the_gripper_when_the_operator_takes_over(show: Show) -> None:
    started(show)
    show.until(FISTED, Stage.RETREAT)
    show.hold(FISTED, 0.2)
    show.hold(PICKING.but(hands=OPENED["right"]), 0.5)
    assert show.task.status is TaskStatus.TAKEN_OVER
    show.hold(PICKING, 0.5)
    assert show.state.fruits[FRUIT] == "held" and not show.state.gripper_open


def test_the_emergency_stop_ends_it_and_a_hand_lost_for_a_moment_only_holds_it(show: Show) -> None:
    started(show)
    show.until(FISTED, Stage.APPROACH)
    paused = show.hold(FISTED.but(hands=Hands(Hand.UNKNOWN, Hand.FIST, 0.0, 1.0)), 0.9)
    assert show.task.status is TaskStatus.RUNNING
    assert Reason.HAND_UNKNOWN in paused[-1].command.reasons and paused[-1].command.stand_still
    show.hold(FISTED, 0.5)
    assert show.task.status is TaskStatus.RUNNING
    show.world.estop()
    stopped = show.show(FISTED, Inputs(estop=True))
    assert stopped.command.stand_still
    assert (show.task.status, show.task.reason) == (TaskStatus.TAKEN_OVER, Reason.ESTOP)
    show.world.estop_reset()


def test_pointing_at_nothing_declines_the_preview(show: Show) -> None:
    previewed(show)
    show.hold(PICKING.but(left=BESIDE_HEAD, right=HANGING), 1.6)
    assert (show.task.status, show.task.reason) == (TaskStatus.CANCELLED, Reason.ASSIST_DECLINED)


def test_the_console_opens_a_preview_that_the_operators_fist_confirms(show: Show) -> None:
    show.show(PICKING, Inputs(picks=(PickAsk("a", fruit=FRUIT),)))
    assert (show.task.id, show.task.status, show.task.attended) == ("a", TaskStatus.PREVIEW, True)
    show.show(PICKING, Inputs(picks=(PickAsk("a", "confirm"),)))
    assert show.task.status is TaskStatus.PREVIEW
    show.hold(FISTED, 0.4)
    assert show.task.status is TaskStatus.RUNNING


def test_moving_the_lift_by_the_api_takes_over(show: Show) -> None:
    started(show)
    show.show(FISTED, Inputs(request=RobotRequest(lift_m=0.3)))
    assert (show.task.status, show.task.reason) == (TaskStatus.TAKEN_OVER, Reason.ASSIST_REQUEST)


def test_pointing_can_be_switched_off(world: World) -> None:
    config = TeleopConfig()
    off = config.intent.assist.model_copy(update={"pointing": "off"})
    config = config.model_copy(update={"intent": config.intent.model_copy(update={"assist": off})})
    state = world.reset()
    begun = Show(engaged(config, PICKING), world, Scenery(hard(world.scenery()), world.fruits), state=state)
    begun.hold(PICKING.but(left=BESIDE_HEAD, right=pointing_at(FRUIT, begun)), 2.0)
    assert begun.rig.state.kernel.assist.task is None


def test_both_hands_beside_the_head_still_disengage(show: Show) -> None:
    show.hold(PICKING.but(left=BESIDE_HEAD, right=BESIDE_HEAD), 1.6)
    assert show.rig.state.kernel.assist.task is None
    assert show.rig.state.intent.mode is Mode.SEEN


def test_left_handed_operators_point_with_the_left_and_confirm_with_the_right(world: World) -> None:
    config = TeleopConfig()
    mapping = config.intent.mapping.model_copy(update={"handedness": "left"})
    config = config.model_copy(update={"intent": config.intent.model_copy(update={"mapping": mapping})})
    state = world.reset()
    begun = Show(engaged(config, PICKING), world, Scenery(hard(world.scenery()), world.fruits), state=state)
    begun.hold(PICKING, 0.3)
    begun.hold(PICKING.but(right=BESIDE_HEAD, left=pointing_at(FRUIT, begun)), 1.6)
    begun.hold(PICKING, 0.3)
    assert (begun.task.fruit, begun.task.status) == (FRUIT, TaskStatus.PREVIEW)
    begun.hold(replace(PICKING, hands=Hands(Hand.FIST, Hand.OPEN, 1.0, 1.0)), 0.4)
    assert begun.task.confirmation.confirmed
    begun.hold(FISTED, 0.4)
    assert begun.task.status is TaskStatus.RUNNING
