"""From hands to tools: gripper, cutter, spray switch, liquid (specification, section 5)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from robot_sim.commands import Liquid
from teleop.intent_types import Event, Hand, Hands, Mode
from teleop.reasons import Reason

LIQUIDS: Final = (Liquid.WATER, Liquid.NUTRIENT, Liquid.PESTICIDE)


@dataclass(frozen=True, slots=True)
class ToolState:
    """Memory of the tools. right, left: what the hand showed last in this task, None before it showed anything.

    right_changed, left_changed: the hand has changed state since the task was entered, so its tool may move.
    """

    right: Hand | None = None
    left: Hand | None = None
    right_changed: bool = False
    left_changed: bool = False
    gripper_open: bool | None = None
    cutter_closed: bool = False
    spray_on: bool = False
    liquid: Liquid = Liquid.WATER


def rest(state: ToolState) -> ToolState:
    """Tools outside the working modes: spray off, cutter open, gripper as it is; hands must change anew."""
    return ToolState(gripper_open=state.gripper_open, liquid=state.liquid)


def step_tools(
    state: ToolState, task: Mode, hands: Hands, hanging: bool = False
) -> tuple[ToolState, tuple[Reason, ...]]:
    """One frame in a task, with debounced hands. An unknown hand opens nothing and starts nothing.

    hanging: the arm of the spray hand hangs down; a hand that relaxes there starts nothing either.
    """
    right_fell = state.right is Hand.OPEN and hands.right is Hand.FIST
    right_rose = state.right is Hand.FIST and hands.right is Hand.OPEN
    left_fell = state.left is Hand.OPEN and hands.left is Hand.FIST
    left_rose = state.left is Hand.FIST and hands.left is Hand.OPEN
    after = replace(
        state,
        right=state.right if hands.right is Hand.UNKNOWN else hands.right,
        left=state.left if hands.left is Hand.UNKNOWN else hands.left,
        right_changed=state.right_changed or right_fell or right_rose,
        left_changed=state.left_changed or left_fell or left_rose,
    )
    reasons: list[Reason] = []
    if Hand.UNKNOWN in (hands.right, hands.left):
        reasons.append(Reason.HAND_UNKNOWN)
    if not (after.right_changed and after.left_changed):
        reasons.append(Reason.HAND_NOT_CHANGED)
    if task is Mode.PICKING:
        if after.right_changed and hands.right is not Hand.UNKNOWN:
            after = replace(after, gripper_open=hands.right is Hand.OPEN)
        closed = after.left_changed and hands.left is Hand.FIST
        return replace(after, cutter_closed=closed, spray_on=False), tuple(reasons)
    if right_rose and hanging:
        reasons.append(Reason.HAND_HANGING)
    spray_on = hands.right is Hand.OPEN and (state.spray_on or (right_rose and not hanging))
    liquid = LIQUIDS[(LIQUIDS.index(state.liquid) + 1) % len(LIQUIDS)] if left_rose else state.liquid
    return replace(after, spray_on=spray_on, liquid=liquid, cutter_closed=False), tuple(reasons)


def tool_events(t_ns: int, before: ToolState, after: ToolState) -> tuple[Event, ...]:
    """What the tools did at this frame, as events."""
    events: list[Event] = []
    if before.spray_on != after.spray_on:
        events.append(Event(t_ns, "tool", "tool.spray_on" if after.spray_on else "tool.spray_off"))
    if before.cutter_closed != after.cutter_closed:
        events.append(Event(t_ns, "tool", "tool.cutter_closed" if after.cutter_closed else "tool.cutter_open"))
    if before.gripper_open is not after.gripper_open:
        events.append(Event(t_ns, "tool", "tool.gripper_open" if after.gripper_open else "tool.gripper_closed"))
    if before.liquid is not after.liquid:
        events.append(Event(t_ns, "tool", "tool.liquid", str(after.liquid)))
    return tuple(events)
