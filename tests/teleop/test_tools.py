"""Hands to tools: nothing before a change, unknown opens and starts nothing."""

from hypothesis import given
from hypothesis import strategies as st

from robot_sim.commands import Liquid
from teleop.intent_types import Hand, Hands, Mode
from teleop.reasons import Reason
from teleop.tools import ToolState, rest, step_tools, tool_events

OPEN, FIST, NONE = Hand.OPEN, Hand.FIST, Hand.UNKNOWN


def run(task: Mode, hands: list[tuple[Hand, Hand]], state: ToolState = ToolState()) -> list[ToolState]:
    out = []
    for right, left in hands:
        state, _ = step_tools(state, task, Hands(right, left, 1.0, 1.0))
        out.append(state)
    return out


def test_gripper_waits_for_a_change_and_then_follows_the_right_hand() -> None:
    states = run(Mode.PICKING, [(OPEN, NONE), (OPEN, NONE), (FIST, NONE), (NONE, NONE), (OPEN, NONE)])
    assert [s.gripper_open for s in states] == [None, None, False, False, True]


def test_cutter_follows_the_left_fist() -> None:
    states = run(Mode.PICKING, [(NONE, OPEN), (NONE, FIST), (NONE, FIST), (NONE, NONE), (NONE, OPEN)])
    assert [s.cutter_closed for s in states] == [False, True, True, False, False]
    assert not run(Mode.PICKING, [(NONE, FIST), (NONE, FIST)])[-1].cutter_closed


def test_spray_starts_on_fist_to_open_only() -> None:
    assert not any(s.spray_on for s in run(Mode.SPRAYING, [(OPEN, NONE)] * 5))
    states = run(
        Mode.SPRAYING,
        [
            (OPEN, NONE),
            (FIST, NONE),
            (OPEN, NONE),
            (NONE, NONE),
            (OPEN, NONE),
            (FIST, NONE),
            (OPEN, NONE),
            (FIST, NONE),
        ],
    )
    assert [s.spray_on for s in states] == [False, False, True, False, False, False, True, False]


def test_a_hand_that_relaxes_on_a_hanging_arm_starts_nothing() -> None:
    state, _ = step_tools(ToolState(), Mode.SPRAYING, Hands(FIST, NONE), hanging=True)
    state, reasons = step_tools(state, Mode.SPRAYING, Hands(OPEN, NONE), hanging=True)
    assert not state.spray_on and Reason.HAND_HANGING in reasons
    state, _ = step_tools(state, Mode.SPRAYING, Hands(OPEN, NONE), hanging=False)
    assert not state.spray_on, "raising an open hand is no change"


def test_left_hand_steps_the_liquids_in_a_ring() -> None:
    states = run(Mode.SPRAYING, [(NONE, OPEN)] + [(NONE, FIST), (NONE, OPEN)] * 3)
    assert [s.liquid for s in states[::2]] == [Liquid.WATER, Liquid.NUTRIENT, Liquid.PESTICIDE, Liquid.WATER]


def test_rest_keeps_the_fruit_and_the_liquid_and_asks_for_a_new_change() -> None:
    state = run(Mode.PICKING, [(OPEN, OPEN), (FIST, FIST)])[-1]
    after = rest(state)
    assert after.gripper_open is False
    assert not (after.cutter_closed or after.spray_on or after.right_changed or after.left_changed)


HANDS = st.lists(st.tuples(st.sampled_from(Hand), st.sampled_from(Hand)), max_size=40)


@given(HANDS, st.sampled_from([Mode.PICKING, Mode.SPRAYING]))
def test_unknown_never_opens_and_never_starts(hands: list[tuple[Hand, Hand]], task: Mode) -> None:
    state = ToolState()
    for right, left in hands:
        before = state
        state, reasons = step_tools(state, task, Hands(right, left))
        if right is NONE:
            assert not state.spray_on
            assert state.gripper_open is before.gripper_open
            assert Reason.HAND_UNKNOWN in reasons
        if left is NONE:
            assert not state.cutter_closed
            assert state.liquid is before.liquid
        if not state.right_changed:
            assert state.gripper_open is None and not state.spray_on
        assert not (task is Mode.PICKING and state.spray_on)


def test_events_say_what_the_tools_did() -> None:
    before, after = ToolState(), ToolState(spray_on=True, liquid=Liquid.NUTRIENT, gripper_open=True)
    assert [event.reason for event in tool_events(5, before, after)] == [
        "tool.spray_on",
        "tool.gripper_open",
        "tool.liquid",
    ]
