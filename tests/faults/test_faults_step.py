"""Faults through Pipeline.step: what the robot is told, after which time, with which reason."""

import os
from dataclasses import replace

import numpy as np
import pytest
from scripted import PERIOD_NS, engaged, rig
from stick_figure import BESIDE_HEAD, CAMERA, CROSSED, FISTS, OPEN_HANDS, Person, frame, joints, raised, skeleton

from benchmarks.faults.sequences import play_sequences, still
from robot_sim.commands import ArmTarget, Liquid, RobotCommand
from teleop.frames import DepthFrame
from teleop.inputs import Inputs, RobotRequest
from teleop.intent_types import Hand, Hands, Mode, Zone
from teleop.skeleton import Skeleton

SEQUENCES = int(os.environ.get("TELEOP_SEQUENCES", "150"))
"""Random sequences of frames, buttons and requests; ``python -m benchmarks faults`` plays thousands."""
PICK = Person(legs_apart_deg=25)
SPRAY = Person()
PLACES = {
    Mode.PICKING: PICK,
    Mode.SPRAYING: SPRAY,
    Mode.FORWARD: Person(z=1.65),
    Mode.BACK: Person(z=3.1),
    Mode.LEFT: Person(x=-0.65),
    Mode.RIGHT: Person(x=0.65),
}


def test_nothing_moves_before_anybody_engages() -> None:
    r = rig()
    for person in (None, *PLACES.values(), PICK.but(right=raised(outward_deg=90))):
        for out in r.hold(person, 0.7):
            assert still(out.command)
            assert out.command.reasons


@pytest.mark.parametrize("mode", PLACES)
def test_each_place_leads_to_its_mode(mode: Mode) -> None:
    r = engaged(person=PLACES[mode])
    out = r.show(PLACES[mode])
    assert out.intent.mode is mode
    command = out.command
    assert (command.drive_m_s > 0, command.drive_m_s < 0) == (mode is Mode.FORWARD, mode is Mode.BACK)
    assert (command.turn_rad_s > 0, command.turn_rad_s < 0) == (mode is Mode.LEFT, mode is Mode.RIGHT)


def test_engage_gesture_engages_and_disengages() -> None:
    r = rig()
    up = PICK.but(right=BESIDE_HEAD, left=BESIDE_HEAD, hands=OPEN_HANDS)
    r.hold(PICK, 0.5)
    modes = [out.intent.mode for out in r.hold(up, 1.5)]
    assert Mode.SEEN in modes and modes[-1] is not Mode.SEEN
    r.hold(PICK, 2.0)
    assert r.show(PICK).intent.mode is Mode.PICKING
    outs = r.hold(up, 1.5)
    assert outs[-1].intent.mode is Mode.SEEN
    held = next(i for i, out in enumerate(outs) if "hold.gesture" in out.command.reasons)
    assert held <= 6 and all(still(out.command) for out in outs[held:]), "the arms do not follow the gesture"


@pytest.mark.parametrize("hands", [Hands(), FISTS, replace(OPEN_HANDS, left=Hand.UNKNOWN)])
def test_hands_that_are_not_both_seen_open_engage_nobody(hands: Hands) -> None:
    r = rig()
    for out in r.hold(PICK.but(right=BESIDE_HEAD, left=BESIDE_HEAD, hands=hands), 2.0):
        assert out.intent.mode in (Mode.NO_PERSON, Mode.SEEN) and out.intent.engage_progress == 0.0


@pytest.mark.parametrize(("x", "stays_s"), [(1.2, 0.3), (0.65, 2.0)])
def test_zone_is_none_when_the_operator_has_left_or_is_lost(x: float, stays_s: float) -> None:
    r = engaged(person=PLACES[Mode.RIGHT])
    r.hold(PLACES[Mode.RIGHT].but(x=x), 0.5)
    outs = list(r.until(None, 3.0))
    none = next(t for t, out in outs if out.intent.zone is Zone.NONE)
    assert none <= (1 / 30 if x > 1 else 0.3 + 2 / 30), "who walks out is gone at once"
    assert [out.intent.zone for t, out in outs if t >= none] == [Zone.NONE] * (len(outs) - round(none * 30) + 1)
    gone = next(t for t, out in outs if out.intent.mode is Mode.NO_PERSON)
    assert gone == pytest.approx(stays_s, abs=2 / 30)
    assert any(e.kind == "zone" and e.detail.endswith("-> none") for _, out in outs for e in out.intent.events)


@pytest.mark.parametrize("mode", PLACES)
def test_estop_in_each_mode_latches_until_its_reset(mode: Mode) -> None:
    r = engaged(person=PLACES[mode])
    out = r.show(PLACES[mode], Inputs(estop=True))
    assert out.intent.mode is Mode.STOPPED and still(out.command) and "stop.estop" in out.command.reasons
    assert [e.reason for e in out.intent.events if e.kind == "estop"] == ["stop.estop"]
    for inputs in (Inputs(), Inputs(engage=True), Inputs(request=RobotRequest(drive_m_s=1.0, lift_m=0.5))):
        out = r.show(PLACES[mode], inputs)
        assert out.intent.mode is Mode.STOPPED and still(out.command) and out.command.lift_m is None
    assert "refused.request_estop" in out.command.reasons
    r.show(PLACES[mode], Inputs(estop_reset=True))
    out = r.hold(PLACES[mode], 1.0)[-1]
    assert out.intent.mode is Mode.SEEN and still(out.command), "a reset does not engage"


def test_estop_counts_on_a_refused_frame() -> None:
    r = engaged(person=PLACES[Mode.FORWARD])
    out = r.push(frame(r.t_ns, r.seq), Inputs(estop=True))
    assert out.intent.mode is Mode.STOPPED and still(out.command)


@pytest.mark.parametrize("mode", PLACES)
def test_body_stop_in_each_mode(mode: Mode) -> None:
    r = engaged(person=PLACES[mode])
    crossed = PLACES[mode].but(right=CROSSED, left=CROSSED)
    stopped = next(t for t, out in r.until(crossed, 1.0) if out.intent.mode is Mode.STOPPED)
    assert stopped <= 0.3 + 2 / 30
    out = r.show(crossed)
    assert still(out.command) and "stop.body" in out.command.reasons
    assert r.hold(PLACES[mode], 1.0)[-1].intent.mode is Mode.SEEN, "the operator has to engage again"


@pytest.mark.parametrize("mode", PLACES)
def test_operator_lost_holds_after_300_ms_and_disengages_after_two_seconds(mode: Mode) -> None:
    r = engaged(person=PLACES[mode])
    outs = list(r.until(None, 3.0))
    held = next(t for t, out in outs if out.intent.mode is Mode.HELD)
    assert held == pytest.approx(0.3, abs=2 / 30)
    gone = next(t for t, out in outs if out.intent.mode is Mode.NO_PERSON)
    assert gone == pytest.approx(2.0, abs=0.1)
    for t, out in outs:
        if t >= held:
            assert still(out.command)
            assert {"hold.tracking_lost", "stop.no_person"} & set(out.command.reasons)
    assert r.hold(PLACES[mode], 1.0)[-1].intent.mode is Mode.SEEN


def test_operator_back_in_time_goes_on_easing_in() -> None:
    r = engaged(person=PICK)
    r.hold(None, 1.0)
    outs = r.hold(PICK.but(right=raised(outward_deg=90)), 2.5)
    assert outs[-1].intent.mode is Mode.PICKING
    sent = [out.command.right_arm.c2_deg for out in outs if out.command.right_arm]
    assert sent[-1] == 90.0 and max(np.diff(sent)) <= 15.0
    assert any("limit.ease_in" in out.command.reasons for out in outs)


def test_duplicate_reordered_and_stale_frames_change_nothing() -> None:
    r = engaged(person=PICK)
    last = r.show(PICK)
    for dt_ns, reason in ((0, "refused.frame_duplicate"), (-50_000_000, "refused.frame_reordered")):
        r.seq += 1
        r.tracker.skeletons[r.seq] = skeleton(Person(x=3.0, z=9.0))
        out = r.push(frame(r.t_ns + dt_ns, r.seq))
        assert not out.accepted
        assert reason in out.command.reasons
        assert replace(out.command, reasons=()) == replace(last.command, reasons=())
    assert r.show(PICK).intent.mode is Mode.PICKING


def test_a_future_stamp_disengages_and_does_not_move_the_robot() -> None:
    r = engaged(person=PLACES[Mode.FORWARD])
    out = r.push(frame(r.t_ns + 60_000_000_000, r.seq))
    assert still(out.command)
    assert any(e.reason == "mode.stream_restarted" for e in out.intent.events)


@pytest.mark.parametrize(("value", "reason"), [(0, "refused.frame_blank"), (4000, "refused.frame_saturated")])
def test_blank_and_saturated_frames_hold_after_300_ms(value: int, reason: str) -> None:
    r = engaged(person=PLACES[Mode.FORWARD])
    picture = np.full((120, 160), value, np.uint16)
    held = None
    for i in range(20):
        r.t_ns += PERIOD_NS
        out = r.push(DepthFrame(r.t_ns, picture, CAMERA))
        assert not out.accepted and reason in out.command.reasons
        if held is None and still(out.command):
            held = (i + 1) / 30
    assert held == pytest.approx(0.3, abs=2 / 30)
    assert out.intent.mode is Mode.HELD


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e9])
def test_joints_that_are_no_numbers_hold(value: float) -> None:
    r = engaged(person=PICK)
    bad = Skeleton(0, np.full((20, 3), value), np.full(20, np.nan))
    outs = r.hold(bad, 0.5)
    assert outs[-1].intent.mode is Mode.HELD and still(outs[-1].command)
    assert r.hold(PICK, 1.0)[-1].intent.mode is Mode.PICKING


def test_teleporting_arm_does_not_move_the_servo() -> None:
    r = engaged(person=PICK)
    r.hold(PICK, 1.0)
    before = r.show(PICK).command.right_arm
    thrown = joints(PICK)
    thrown[3] += (0.5, 1.0, 0.0)
    thrown[5] += (1.0, 2.0, 0.0)
    for _ in range(2):
        out = r.show(Skeleton(0, thrown, np.ones(20)))
        assert out.command.right_arm == before
        assert "refused.joint_jump" in out.command.reasons
    assert r.show(PICK).command.right_arm == before


def test_left_right_swap_holds_the_arms() -> None:
    person = PICK.but(right=raised(outward_deg=60))
    r = engaged(person=person)
    r.hold(person, 2.0)
    before = r.show(person).command
    swapped = joints(person)
    for a, b in ((2, 19), (3, 18), (5, 15), (6, 14)):
        swapped[[a, b]] = swapped[[b, a]]
    for _ in range(4):
        out = r.show(Skeleton(0, swapped, np.ones(20)))
        assert (out.command.right_arm, out.command.left_arm) == (before.right_arm, before.left_arm)


def test_second_person_elsewhere_never_takes_over() -> None:
    r = engaged(person=PLACES[Mode.FORWARD])
    outs = r.hold(Person(x=-0.7, z=3.0), 2.0)
    assert not any(out.command.turn_rad_s for out in outs)
    assert outs[-1].intent.mode is Mode.SEEN
    assert any(e.reason == "mode.operator_changed" for out in outs for e in out.intent.events)


def test_tracker_reset_disengages() -> None:
    r = engaged(person=PICK)
    out = r.show(PICK, reset=True)
    assert out.intent.mode is Mode.SEEN and still(out.command)


def test_camera_unplugged() -> None:
    r = engaged(person=PLACES[Mode.FORWARD])
    out = r.show(PLACES[Mode.FORWARD], Inputs(source_failed=True))
    assert still(out.command) and "stop.source_failed" in out.command.reasons


def test_two_sources_commanding_at_once() -> None:
    request = RobotRequest(drive_m_s=1.0, lift_m=0.4, spray_on=True, right_arm=ArmTarget(90, 90, 90))
    r = engaged(person=PICK)
    out = r.show(PICK, Inputs(request=request))
    assert out.command.lift_m == 0.4, "the lift is the console's"
    assert out.command.drive_m_s == 0.0 and not out.command.spray_on
    assert out.command.right_arm != request.right_arm
    assert "refused.request_operator_engaged" in out.command.reasons
    r = rig()
    out = r.show(None, Inputs(request=replace(request, liquid=Liquid.PESTICIDE)))
    assert (out.command.drive_m_s, out.command.right_arm, out.command.liquid) == (1.0, request.right_arm, "pesticide")
    assert r.show(None).command.drive_m_s == 0.0, "a silent client stops the chassis"


def test_requests_that_are_no_numbers_are_refused() -> None:
    r = rig()
    for bad in (RobotRequest(lift_m=np.nan), RobotRequest(right_arm=ArmTarget(np.inf, 0, 0))):
        out = r.show(None, Inputs(request=bad))
        assert still(out.command) and out.command.lift_m is None
        assert "refused.request_not_finite" in out.command.reasons


def test_out_of_range_is_a_stop() -> None:
    r = engaged(person=PLACES[Mode.FORWARD])
    out = r.hold(Person(z=1.2), 1.0)[-1]
    assert out.intent.zone is Zone.OUT and out.intent.mode is Mode.HELD
    assert still(out.command) and "stop.out_of_range" in out.command.reasons


def test_arms_lock_while_the_disc_turns() -> None:
    r = engaged(person=PICK)
    outs = r.hold(SPRAY, 4.0)
    turning = [out for out in outs if "hold.disc_turning" in out.command.reasons]
    assert len(turning) == pytest.approx(60, abs=3)
    for out in turning:
        assert out.command.disc_rad == pytest.approx(np.pi)
        assert out.command.rear_arm is None and not out.command.spray_on
    assert outs[-1].command.rear_arm is not None
    assert (outs[-1].command.right_arm, outs[-1].command.left_arm) == (None, None)


def test_same_frames_same_commands() -> None:
    def commands() -> list[RobotCommand]:
        r = engaged(person=PICK)
        r.rng = np.random.default_rng(1)
        return [out.command for person in PLACES.values() for out in r.hold(person, 0.4)]

    assert commands() == commands()


def test_no_sequence_of_frames_buttons_and_requests_moves_the_robot_wrongly() -> None:
    worst = play_sequences(SEQUENCES)
    assert worst.sequences >= SEQUENCES and worst.moved > worst.sequences, "the robot did move"
