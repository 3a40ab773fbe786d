"""The state machine: legal ways only, and a reason for each step."""

from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleop.intent_types import Mode, Zone
from teleop.modes import ACTING, LEGAL, Conditions, IllegalTransition, next_mode, transition
from teleop.reasons import Reason

GOOD = Conditions(person=True, tracked=True, engaged=True, stopped=False, zone=Zone.WORK, task=Mode.PICKING)
ANY = st.builds(
    Conditions,
    person=st.booleans(),
    tracked=st.booleans(),
    engaged=st.booleans(),
    stopped=st.booleans(),
    zone=st.sampled_from(Zone),
    task=st.sampled_from([None, Mode.PICKING, Mode.SPRAYING]),
)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (Mode.NO_PERSON, Mode.ENGAGED),
        (Mode.SEEN, Mode.PICKING),
        (Mode.STOPPED, Mode.ENGAGED),
        (Mode.STOPPED, Mode.FORWARD),
        (Mode.HELD, Mode.SPRAYING),
        (Mode.FORWARD, Mode.PICKING),
    ],
)
def test_illegal_transitions_raise(old: Mode, new: Mode) -> None:
    with pytest.raises(IllegalTransition, match=f"mode {new} cannot follow {old}; legal: "):
        transition(old, new)


def test_motion_is_only_reached_through_engaged() -> None:
    for mode, followers in LEGAL.items():
        if mode not in ACTING and mode is not Mode.ENGAGED:
            assert not followers & ACTING
        assert Mode.STOPPED in followers or mode is Mode.STOPPED


@given(st.sampled_from(Mode), ANY)
def test_every_way_is_legal_ends_and_is_stable(mode: Mode, conditions: Conditions) -> None:
    path = next_mode(mode, conditions)
    for new, reason in path:
        assert new in LEGAL[mode]
        assert isinstance(reason, Reason)
        mode = new
    assert len(path) <= 4
    assert next_mode(mode, conditions) == ()


@given(st.sampled_from(Mode), ANY)
def test_what_the_modes_mean(mode: Mode, c: Conditions) -> None:
    path = next_mode(mode, c)
    mode = path[-1][0] if path else mode
    assert (mode is Mode.STOPPED) == c.stopped
    if mode in ACTING:
        assert c.engaged and c.tracked and not c.stopped and c.zone not in (Zone.OUT, Zone.NONE)


def test_reasons() -> None:
    steps = next_mode(Mode.NO_PERSON, GOOD)
    assert [mode for mode, _ in steps] == [Mode.SEEN, Mode.ENGAGED, Mode.PICKING]
    assert [reason for _, reason in steps] == [Reason.PERSON_SEEN, Reason.ENGAGE_REQUEST, Reason.TASK_SETTLED]
    out = Conditions(True, True, True, False, Zone.OUT, None)
    assert next_mode(Mode.FORWARD, out) == ((Mode.HELD, Reason.OUT_OF_RANGE),)


def test_all_modes_have_rules() -> None:
    assert set(LEGAL) == set(Mode)
    for old, new in product(Mode, Mode):
        assert transition(old, new) is new if new in LEGAL[old] or new is old else True
