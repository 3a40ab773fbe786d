"""Who is in control."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleop.control import Control, Seen, step_control
from teleop.inputs import Inputs
from teleop.reasons import Reason

HERE = Seen(person=True, now=True)
GONE = Seen(person=False, now=False)
ENGAGED = Control(engaged=True)


def test_engaging_by_gesture_and_by_request() -> None:
    by_gesture = step_control(Control(), Seen(True, True, toggle=True), Inputs())
    assert by_gesture.engaged and by_gesture.engage_reason is Reason.ENGAGE_GESTURE
    by_request = step_control(Control(), HERE, Inputs(engage=True))
    assert by_request.engaged and by_request.engage_reason is Reason.ENGAGE_REQUEST


@pytest.mark.parametrize(
    ("seen", "inputs", "reason"),
    [
        (Seen(True, True, toggle=True), Inputs(), Reason.DISENGAGE_GESTURE),
        (HERE, Inputs(disengage=True), Reason.DISENGAGE_REQUEST),
        (Seen(True, True, exchanged=True), Inputs(), Reason.OPERATOR_CHANGED),
        (Seen(True, True, restarted=True), Inputs(), Reason.STREAM_RESTARTED),
        (GONE, Inputs(), Reason.PERSON_LEFT),
    ],
)
def test_what_ends_control(seen: Seen, inputs: Inputs, reason: Reason) -> None:
    after = step_control(ENGAGED, seen, inputs)
    assert not after.engaged
    assert after.end_reason is reason


def test_nobody_there_cannot_be_engaged() -> None:
    after = step_control(Control(), GONE, Inputs(engage=True))
    assert not after.engaged
    assert after.refusals == (Reason.ENGAGE_NO_PERSON,)


def test_estop_latches_covers_engaging_and_needs_its_reset() -> None:
    control = step_control(ENGAGED, HERE, Inputs(estop=True))
    assert control.estop and not control.engaged
    control = step_control(control, HERE, Inputs(engage=True))
    assert control.estop and control.refusals == (Reason.ENGAGE_ESTOP,)
    control = step_control(control, HERE, Inputs(estop=True, estop_reset=True))
    assert control.estop, "an e-stop wins over its reset"
    control = step_control(control, HERE, Inputs(estop_reset=True))
    assert not control.estop and not control.engaged


def test_whoever_is_seen_is_in_control_when_that_is_assumed() -> None:
    control = step_control(Control(assumed=True), HERE, Inputs())
    assert control.engaged and control.engage_reason is Reason.ENGAGE_ASSUMED
    assert step_control(control, Seen(True, True, toggle=True, exchanged=True, restarted=True), Inputs()).engaged
    assert not step_control(control, Seen(True, True, crossed=True), Inputs()).engaged
    assert not step_control(control, HERE, Inputs(estop=True)).engaged


SEEN = st.builds(Seen, *[st.booleans()] * 2, toggle=st.booleans(), crossed=st.booleans(), exchanged=st.booleans())
INPUTS = st.builds(Inputs, *[st.booleans()] * 4)


@given(st.lists(st.tuples(SEEN, INPUTS), max_size=30), st.booleans())
def test_never_engaged_when_stopped_or_alone(steps: list[tuple[Seen, Inputs]], assumed: bool) -> None:
    control = Control(assumed=assumed)
    for seen, inputs in steps:
        before = control
        control = step_control(control, seen, inputs)
        if control.estop or seen.crossed or not seen.person:
            assert not control.engaged
        if before.estop and not control.estop:
            assert inputs.estop_reset and not inputs.estop
        if not before.engaged and control.engaged:
            assert seen.now and (inputs.engage or seen.toggle or assumed)
