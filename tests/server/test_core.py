"""One control step with the real pipeline and robot, and a clock of our own."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from live_server import frames, tracker

from robot_sim.world import World
from server.engine.core import Core
from server.engine.ledger import Ledger
from server.engine.mailbox import Arrived
from server.settings import Settings
from teleop.inputs import RobotRequest
from teleop.intent_types import Mode
from teleop.modes import IN_CONTROL
from teleop.reasons import Reason


class Clock:
    def __init__(self) -> None:
        self.now = 50.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    made = World()
    yield made
    made.close()


@pytest.fixture
def core(world: World) -> tuple[Core, Clock]:
    world.reset()
    settings, clock = Settings(), Clock()
    return Core(tracker(settings), world, settings, Ledger(100), clock), clock


def play(core: Core, clock: Clock, first: int, count: int) -> None:
    for i in range(first, first + count):
        clock.now += 1 / 30
        core.on_frame(Arrived(frames()[i], clock.now, i / 30), live=False, speed=1.0)


def test_silence_holds_after_200_ms_and_stops_after_500_ms(core: tuple[Core, Clock]) -> None:
    engine, clock = core
    play(engine, clock, 0, 5)
    seen: dict[int, tuple[str, ...]] = {}
    events: list[str] = []
    for ms in range(33, 700, 33):
        clock.now += 0.033
        moment = engine.on_silence(source_failed=False, speed=1.0)
        seen[ms] = moment.command.reasons
        events += [e.reason for e in moment.events]
    assert Reason.NO_FRAME_HOLD not in seen[165] and Reason.NO_FRAME_HOLD in seen[231]
    assert Reason.NO_FRAME_STOP not in seen[462] and Reason.NO_FRAME_STOP in seen[528]
    assert events == [Reason.NO_FRAME_HOLD, Reason.NO_FRAME_STOP], "each is told once"
    play(engine, clock, 5, 1)
    assert not engine.on_silence(source_failed=False, speed=1.0).events


def test_a_failed_source_stops_at_once(core: tuple[Core, Clock]) -> None:
    engine, clock = core
    play(engine, clock, 0, 3)
    moment = engine.on_silence(source_failed=True, speed=1.0)
    assert Reason.SOURCE_FAILED in moment.command.reasons
    assert moment.command.drive_m_s == 0.0 and not moment.command.spray_on


def test_nobody_can_be_engaged_while_no_frame_comes(core: tuple[Core, Clock]) -> None:
    engine, clock = core
    clock.now += 1.0
    engine.pending.engage = True
    assert [e.reason for e in engine.on_silence(False, 1.0).events if e.kind == "refused"] == [Reason.ENGAGE_NO_PERSON]
    assert not [e for e in engine.on_silence(False, 1.0).events if e.kind == "refused"]


def test_a_wish_to_engage_between_two_frames_waits_for_the_next(core: tuple[Core, Clock]) -> None:
    engine, clock = core
    play(engine, clock, 0, 10)
    engine.pending.engage = True
    clock.now += 0.02
    between = engine.on_silence(False, 1.0)
    assert not between.events and not between.inputs.engage
    clock.now += 0.02
    moment = engine.on_frame(Arrived(frames()[10], clock.now, 0.33), live=False, speed=1.0)
    assert moment.inputs.engage and moment.output is not None and moment.output.intent.mode in IN_CONTROL


def test_speeds_end_when_they_are_not_repeated(core: tuple[Core, Clock]) -> None:
    engine, clock = core
    engine.on_silence(False, 1.0)
    engine.pending.ask(RobotRequest(drive_m_s=0.2), clock.now + 0.25)
    driven = []
    for _ in range(15):
        clock.now += 0.033
        driven.append(engine.on_silence(False, 1.0).command.drive_m_s)
    assert driven[:5] == [0.2] * 5 and driven[-5:] == [0.0] * 5


def test_an_emergency_stop_survives_another_source_and_a_configuration(core: tuple[Core, Clock]) -> None:
    engine, clock = core
    engine.estop()
    engine.forget()
    engine.configure(Settings())
    play(engine, clock, 0, 1)
    moment = engine.on_frame(Arrived(frames()[1], clock.now, 0.03), live=False, speed=1.0)
    assert moment.robot.estop and Reason.ESTOP in moment.command.reasons
    engine.estop_reset()
    clock.now += 0.033
    moment = engine.on_frame(Arrived(frames()[2], clock.now, 0.06), live=False, speed=1.0)
    assert not moment.robot.estop and Reason.ESTOP not in moment.command.reasons


def test_an_emergency_stop_without_frames_is_told_and_recorded_and_ends_with_its_reset(
    core: tuple[Core, Clock],
) -> None:
    engine, clock = core
    play(engine, clock, 0, 4)
    clock.now += 1.0
    engine.estop()
    stopped = engine.on_silence(False, 1.0)
    assert [(e.kind, e.reason) for e in stopped.events if e.kind == "estop"] == [("estop", Reason.ESTOP)]
    assert stopped.inputs.estop and stopped.output is not None and stopped.output.intent.mode is Mode.STOPPED
    assert not [e for e in engine.on_silence(False, 1.0).events if e.kind == "estop"], "told once"
    engine.estop_reset()
    released = engine.on_silence(False, 1.0)
    assert Reason.ESTOP_RESET in [e.reason for e in released.events] and released.inputs.estop_reset
    assert released.output is not None and released.output.intent.mode is not Mode.STOPPED
    assert released.command.drive_m_s == 0.0


def test_an_emergency_stop_and_its_reset_within_one_step_are_both_told(core: tuple[Core, Clock]) -> None:
    engine, clock = core
    play(engine, clock, 0, 2)
    engine.estop()
    engine.estop_reset()
    events = [e.reason for _ in range(2) for e in engine.on_silence(False, 1.0).events if e.kind == "estop"]
    assert events == [Reason.ESTOP, Reason.ESTOP_RESET]


def test_an_emergency_stop_before_the_first_frame_of_a_recorded_session_is_kept(core: tuple[Core, Clock]) -> None:
    engine, clock = core
    engine.estop()
    engine.forget(reset_robot=True)
    engine.on_silence(False, 1.0)
    play(engine, clock, 0, 1)
    moment = engine.on_frame(Arrived(frames()[1], clock.now, 0.03), live=False, speed=1.0)
    assert moment.output is not None and moment.output.intent.mode is Mode.STOPPED and moment.robot.estop


def test_the_robots_time_runs_with_the_replay_within_its_bound(core: tuple[Core, Clock]) -> None:
    engine, clock = core
    engine.on_silence(False, 1.0)
    start_s = engine.world.state().sim_time_s
    clock.now += 0.025
    after_s = engine.on_silence(False, 2.0).robot.sim_time_s
    assert after_s - start_s == pytest.approx(0.05, abs=1 / 240)
    clock.now += 60.0
    assert engine.on_silence(False, 1.0).robot.sim_time_s - after_s == pytest.approx(0.1, abs=1 / 240)


def test_a_loop_puts_the_robot_back_to_its_start(core: tuple[Core, Clock]) -> None:
    engine, clock = core
    engine.pending.ask(RobotRequest(lift_m=0.3), clock.now)
    for _ in range(40):
        clock.now += 0.1
        engine.on_silence(False, 1.0)
    assert engine.world.state().joint_rad["lift"] > 0.25
    moment = engine.on_frame(Arrived(frames()[0], clock.now, 0.0, restarted=True), live=False, speed=1.0)
    assert moment.robot.joint_rad["lift"] < 0.15


def test_a_stop_asked_for_while_a_picture_is_tracked_counts_in_that_step(core: tuple[Core, Clock]) -> None:
    engine, clock = core
    engine.pending.ask(RobotRequest(drive_m_s=0.3), clock.now + 9.0)
    play(engine, clock, 0, 20)
    before = engine.world.state().drive_m_s
    assert before > 0.2
    engine.look_up = lambda: engine.estop()
    clock.now += 1 / 30
    moment = engine.on_frame(Arrived(frames()[20], clock.now, 20 / 30), live=False, speed=1.0)
    assert moment.told is not None and moment.told.estop, "so that a replay stops there, too"
    assert moment.robot.estop and moment.robot.drive_m_s < before - 0.1
    assert not moment.inputs.estop, "the operator's state learns it with the next inputs"
    engine.look_up = lambda: None
    clock.now += 1 / 30
    after = engine.on_frame(Arrived(frames()[21], clock.now, 21 / 30), live=False, speed=1.0)
    assert after.inputs.estop and Reason.ESTOP in after.command.reasons
