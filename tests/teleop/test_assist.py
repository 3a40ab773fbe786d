"""The assisted pick from the operator's side: hands, ways to take over, asks of the API. Pure, with an ideal robot."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache

import pytest
from ideal_robot import IdealRobot
from stick_figure import Person, skeleton

from robot_sim.actuators import JOINTS
from robot_sim.commands import Liquid
from robot_sim.config import RobotConfig
from robot_sim.greenhouse import greenhouse
from robot_sim.limiter import home_setpoints
from robot_sim.pick.plan import Scenery
from robot_sim.pick.run import STAGES
from robot_sim.pick.surroundings import hard
from robot_sim.state import RobotState
from teleop.assist.hands_rule import step_confirmation
from teleop.assist.step import Assisted, AssistState, Situation, step_assist
from teleop.assist.task import Confirmation, PickTask, RobotView, TaskStatus
from teleop.config.assist import AssistConfig
from teleop.inputs import PickAsk
from teleop.intent_types import Event, Hand, Hands, Mode
from teleop.reasons import Reason

ROBOT, CONFIG = RobotConfig(), AssistConfig()
HOUSE = greenhouse(ROBOT.greenhouse, 0)
SCENERY = Scenery(hard(HOUSE.primitives), HOUSE.fruits)
FRUIT, OTHER = "cucumber_2_fruit_0", "cucumber_1_fruit_0"
OPEN, FIST, UNKNOWN = Hand.OPEN, Hand.FIST, Hand.UNKNOWN
BODY = skeleton(Person(legs_apart_deg=22.0))
FISTS, OPENED = Hands(FIST, FIST), Hands(OPEN, OPEN)


def at_home() -> RobotState:
    home = dict(zip(JOINTS, home_setpoints(ROBOT).position, strict=True))
    return RobotState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, home, home, True, False, False, Liquid.WATER, False)


@dataclass
class Bench:
    """Steps the assisted pick with an ideal robot that does what it is told."""

    mode: Mode = Mode.PICKING
    robot: IdealRobot = field(default_factory=lambda: IdealRobot(at_home(), ROBOT, FRUIT))
    state: AssistState = field(default_factory=AssistState)
    events: list[Event] = field(default_factory=list)
    t_ns: int = 0

    def step(self, hands: Hands = FISTS, *asks: PickAsk, **now: object) -> Assisted:
        self.t_ns += 33_333_333
        told = {"mode": self.mode, "hands": hands, "body": BODY, "dt_s": 1 / 30} | now
        situation = Situation(self.t_ns, **told)  # type: ignore[arg-type]
        view = RobotView(self.robot.state, ROBOT, SCENERY)
        assisted = step_assist(self.state, situation, asks, view, CONFIG)
        self.state = assisted.state
        self.events += assisted.events
        if assisted.wish is not None:
            self.robot.follow(assisted.wish)
        else:
            self.robot.state = replace(self.robot.state, sim_time_s=self.robot.state.sim_time_s + 1 / 30)
        return assisted

    @property
    def task(self) -> PickTask:
        assert self.state.task is not None
        return self.state.task

    @property
    def told(self) -> list[str]:
        return [event.reason for event in self.events]


def ask(fruit: str | None = FRUIT, **given: object) -> PickAsk:
    return PickAsk(str(given.pop("id", "a")), fruit=fruit, **given)  # type: ignore[arg-type]


def another(bench: Bench) -> Bench:
    """A bench of its own in the same moment; what it remembers is frozen."""
    return replace(bench, robot=replace(bench.robot, commands=list(bench.robot.commands)), events=list(bench.events))


@cache
def _previewing() -> Bench:
    bench = Bench()
    bench.step(OPENED, ask())
    return bench


def previewing() -> Bench:
    return another(_previewing())


@cache
def _running(mode: Mode) -> Bench:
    bench = Bench(mode)
    bench.step(OPENED, ask())
    for _ in range(31):
        bench.step(FISTS)
    assert bench.task.status is TaskStatus.RUNNING
    return bench


def running(mode: Mode = Mode.PICKING) -> Bench:
    return another(_running(mode))


def test_a_preview_waits_for_the_left_fist_and_drives_nothing() -> None:
    bench = Bench()
    seen = [bench.step(OPENED, ask())]
    seen += [bench.step(OPENED) for _ in range(10)]
    assert bench.task.status is TaskStatus.PREVIEW and bench.task.plan is not None
    assert all(s.wish is None and s.holds for s in seen)
    assert [s.stops for s in seen] == [True] + [False] * 10, "goals on their way are dropped once"
    assert all(Reason.ASSIST_PREVIEW in s.reasons for s in seen)
    assert bench.told == ["assist.preview"] and bench.robot.commands == []


def test_a_fist_that_was_closed_before_the_preview_confirms_nothing() -> None:
    bench = Bench()
    bench.step(FISTS, ask())
    for _ in range(20):
        bench.step(FISTS)
    assert bench.task.status is TaskStatus.PREVIEW
    bench.step(Hands(FIST, OPEN))
    bench.step(FISTS)
    assert bench.task.status is TaskStatus.RUNNING


def test_confirmed_it_waits_for_the_right_fist_too_and_an_open_left_hand_withdraws() -> None:
    bench = previewing()
    waiting = bench.step(Hands(OPEN, FIST))
    assert bench.task.confirmation.confirmed and Reason.ASSIST_CLOSE_HANDS in waiting.reasons
    bench.step(OPENED)
    assert not bench.task.confirmation.confirmed and bench.task.status is TaskStatus.PREVIEW
    bench.step(Hands(FIST, FIST))
    assert bench.task.status is TaskStatus.RUNNING


@pytest.mark.parametrize(
    ("before", "left", "after"),
    [
        (Confirmation(), OPEN, Confirmation(True, False)),
        (Confirmation(), FIST, Confirmation(False, False)),
        (Confirmation(True), FIST, Confirmation(True, True)),
        (Confirmation(True, True), UNKNOWN, Confirmation(True, True)),
        (Confirmation(True, True), OPEN, Confirmation(True, False)),
        (Confirmation(), UNKNOWN, Confirmation()),
    ],
)
def test_the_rule_of_the_left_hand(before: Confirmation, left: Hand, after: Confirmation) -> None:
    assert step_confirmation(before, Hands(UNKNOWN, left)) == after


def test_a_confirmed_pick_runs_through_all_stages_each_an_event() -> None:
    bench = running()
    for _ in range(1500):
        if not bench.task.active:
            break
        bench.step(FISTS)
    assert bench.task.status is TaskStatus.SUCCEEDED and bench.task.progress == 1.0
    assert bench.told == ["assist.preview", *(f"assist.{stage}" for stage in STAGES), Reason.ASSIST_DONE]
    assert bench.robot.state.fruits == {FRUIT: "boxed"}
    after = bench.step(FISTS)
    assert after.wish is None and not after.holds


TAKEN: list[tuple[str, dict[str, object], Reason]] = [
    ("right hand opens", {"hands": Hands(OPEN, FIST)}, Reason.ASSIST_HAND_OPENED),
    ("left hand opens", {"hands": Hands(FIST, OPEN)}, Reason.ASSIST_HAND_OPENED),
    ("body stop", {"mode": Mode.STOPPED, "stopped": Reason.BODY_STOP}, Reason.BODY_STOP),
    ("emergency stop", {"mode": Mode.STOPPED, "stopped": Reason.ESTOP}, Reason.ESTOP),
    ("no frames", {"stopped": Reason.NO_FRAME_STOP}, Reason.NO_FRAME_STOP),
    ("operator lost", {"mode": Mode.HELD}, Reason.TRACKING_LOST),
    ("operator gone", {"mode": Mode.NO_PERSON}, Reason.NO_PERSON),
    ("disengaged", {"mode": Mode.SEEN}, Reason.NOT_ENGAGED),
    ("steps away", {"mode": Mode.FORWARD}, Reason.ASSIST_LEFT),
    ("closes the legs", {"mode": Mode.SPRAYING}, Reason.ASSIST_LEFT),
    ("a request of the API", {"manual": True}, Reason.ASSIST_REQUEST),
]


@pytest.mark.parametrize(("now", "reason"), [case[1:] for case in TAKEN], ids=[case[0] for case in TAKEN])
def test_the_operator_takes_over_at_once(now: dict[str, object], reason: Reason) -> None:
    bench = running()
    stopped = bench.step(**now)  # type: ignore[arg-type]
    assert stopped.stops and stopped.wish is None
    assert (bench.task.status, bench.task.reason) == (TaskStatus.TAKEN_OVER, reason)
    assert bench.told[-1] == reason
    after = bench.step(FISTS)
    assert not after.holds and not after.stops, "the operator's arms drive again"


def test_hands_that_are_not_read_for_a_moment_only_hold_the_robot() -> None:
    bench = running()
    waiting = [bench.step(Hands(UNKNOWN, FIST)) for _ in range(15)]
    assert all(s.wish is None and s.stops and Reason.HAND_UNKNOWN in s.reasons for s in waiting)
    assert bench.task.status is TaskStatus.RUNNING
    assert bench.step(FISTS).wish is not None
    for _ in range(round(30 * CONFIG.unknown_s) + 1):
        bench.step(Hands(UNKNOWN, FIST))
    assert (bench.task.status, bench.task.reason) == (TaskStatus.TAKEN_OVER, Reason.ASSIST_HANDS_UNKNOWN)


@pytest.mark.parametrize("still", [Reason.GESTURE, Reason.ZONE_UNSETTLED, Reason.NO_FRAME_HOLD, Reason.DISC_TURNING])
def test_what_holds_the_operator_holds_the_pick(still: Reason) -> None:
    bench = running()
    held = bench.step(FISTS, still=still)
    assert held.wish is None and held.stops and still in held.reasons
    assert bench.task.status is TaskStatus.RUNNING


@pytest.mark.parametrize("mode", [Mode.SPRAYING, Mode.FORWARD, Mode.HELD, Mode.SEEN])
def test_a_preview_closes_when_the_operator_leaves(mode: Mode) -> None:
    bench = previewing()
    bench.step(OPENED, mode=mode)
    assert bench.task.status is TaskStatus.CANCELLED


def test_a_preview_that_nobody_confirms_closes_after_a_while() -> None:
    bench = previewing()
    for _ in range(round(30 * CONFIG.preview_s) + 2):
        bench.step(OPENED)
    assert (bench.task.status, bench.task.reason) == (TaskStatus.CANCELLED, Reason.ASSIST_TIMEOUT)


def test_without_an_operator_it_starts_at_once_or_when_it_is_confirmed() -> None:
    bench = Bench(Mode.NO_PERSON)
    bench.step(Hands(), ask(), body=None)
    assert bench.task.status is TaskStatus.RUNNING and not bench.task.attended
    bench = Bench(Mode.SEEN)
    bench.step(Hands(), ask(preview=True))
    for _ in range(10):
        bench.step(FISTS)
    assert bench.task.status is TaskStatus.PREVIEW, "hands of somebody who is not engaged confirm nothing"
    bench.step(Hands(), PickAsk("a", "confirm"))
    assert bench.task.status is TaskStatus.RUNNING


def test_an_operator_who_engages_ends_what_runs_without_one() -> None:
    bench = running(Mode.SEEN)
    bench.step(FISTS, mode=Mode.ENGAGED)
    assert (bench.task.status, bench.task.reason) == (TaskStatus.TAKEN_OVER, Reason.ASSIST_OPERATOR)


def test_the_api_cannot_confirm_for_an_operator() -> None:
    bench = previewing()
    bench.step(Hands(FIST, OPEN), PickAsk("a", "confirm"))
    assert bench.task.status is TaskStatus.PREVIEW


def test_a_running_pick_is_not_replaced_a_preview_is() -> None:
    bench = running()
    busy = bench.step(FISTS, ask(OTHER, id="b"))
    assert bench.task.fruit == FRUIT and bench.task.status is TaskStatus.RUNNING
    assert [(t.id, t.status, t.reason) for t in busy.state.ended] == [("b", TaskStatus.REFUSED, Reason.ASSIST_BUSY)]
    bench = previewing()
    replaced = bench.step(OPENED, ask(OTHER, id="b"))
    assert bench.task.fruit == OTHER and bench.task.status is TaskStatus.PREVIEW
    assert [(t.id, t.reason) for t in replaced.state.ended] == [("a", Reason.ASSIST_REPLACED)]


def test_cancelling_ends_it_and_a_strange_id_does_nothing() -> None:
    bench = running()
    bench.step(FISTS, PickAsk("z", "cancel"), PickAsk("z", "confirm"))
    assert bench.task.status is TaskStatus.RUNNING
    assert bench.step(FISTS, PickAsk("a", "cancel")).stops
    assert (bench.task.status, bench.task.reason) == (TaskStatus.TAKEN_OVER, Reason.ASSIST_CANCELLED)
    bench.step(FISTS, PickAsk("a", "cancel"))
    assert bench.told.count(Reason.ASSIST_CANCELLED) == 1


REFUSED: list[tuple[str, Callable[[Bench], object], str]] = [
    ("out of reach", lambda b: b.step(OPENED, ask("cucumber_5_fruit_0")), "pick.out_of_reach"),
    ("unknown", lambda b: b.step(OPENED, ask("melon")), "pick.no_fruit"),
    ("not picking", lambda b: b.step(OPENED, ask(), mode=Mode.FORWARD), Reason.ASSIST_NOT_PICKING),
    ("stopped", lambda b: b.step(OPENED, ask(), mode=Mode.STOPPED, stopped=Reason.ESTOP), Reason.ESTOP),
]


@pytest.mark.parametrize(("do", "reason"), [case[1:] for case in REFUSED], ids=[case[0] for case in REFUSED])
def test_what_cannot_be_picked_is_a_refused_task_that_says_what_to_do(
    do: Callable[[Bench], object], reason: str
) -> None:
    bench = Bench()
    do(bench)
    assert (bench.task.status, bench.task.reason) == (TaskStatus.REFUSED, reason)
    assert len(bench.task.detail) > 10 and bench.told == [reason]
    if reason == "pick.out_of_reach":
        assert bench.task.forward_m is not None and bench.task.forward_m > 0.5


def test_a_pick_that_fails_says_why_and_gives_the_robot_back() -> None:
    bench = Bench(robot=IdealRobot(at_home(), ROBOT, FRUIT, grips=False))
    bench.step(OPENED, ask())
    for _ in range(1500):
        bench.step(FISTS)
        if not bench.task.active:
            break
    assert (bench.task.status, bench.task.reason) == (TaskStatus.FAILED, "pick.not_gripped")
    assert not bench.step(FISTS).holds


def test_without_a_robot_it_is_refused() -> None:
    assisted = step_assist(AssistState(), Situation(0, Mode.NO_PERSON), [ask()], None, CONFIG)
    assert assisted.state.task is not None and assisted.state.task.reason == Reason.ASSIST_NO_ROBOT
