"""The intent state machine: which mode may follow which, and which one follows now."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from teleop.errors import TeleopError
from teleop.intent_types import Mode, Zone
from teleop.reasons import Reason

ACTING: Final = frozenset({Mode.PICKING, Mode.SPRAYING, Mode.FORWARD, Mode.BACK, Mode.LEFT, Mode.RIGHT})
"""Modes in which the robot moves."""
WORKING: Final = frozenset({Mode.PICKING, Mode.SPRAYING})
CRUISING: Final = ACTING - WORKING
IN_CONTROL: Final = ACTING | {Mode.ENGAGED, Mode.HELD}
"""Modes in which the operator is engaged."""

_ENDS: Final = frozenset({Mode.STOPPED, Mode.SEEN, Mode.NO_PERSON})
LEGAL: Final[dict[Mode, frozenset[Mode]]] = {
    Mode.NO_PERSON: frozenset({Mode.SEEN, Mode.STOPPED}),
    Mode.SEEN: frozenset({Mode.ENGAGED, Mode.NO_PERSON, Mode.STOPPED}),
    Mode.ENGAGED: ACTING | _ENDS | {Mode.HELD},
    Mode.HELD: _ENDS | {Mode.ENGAGED},
    Mode.STOPPED: frozenset({Mode.SEEN, Mode.NO_PERSON}),
    **{mode: _ENDS | {Mode.ENGAGED, Mode.HELD} for mode in ACTING - WORKING},
    **{mode: _ENDS | {Mode.ENGAGED, Mode.HELD} | (WORKING - {mode}) for mode in WORKING},
}
"""From each mode, the modes that may follow. Every way into motion leads through ENGAGED."""


class IllegalTransition(TeleopError):
    """A change of mode that is not in LEGAL: a fault of the program, never of the operator."""

    def __init__(self, old: Mode, new: Mode) -> None:
        self.old, self.new = old, new
        super().__init__(f"mode {new} cannot follow {old}; legal: {', '.join(sorted(LEGAL[old]))}")


def transition(old: Mode, new: Mode) -> Mode:
    """The new mode. Raises IllegalTransition when it cannot follow the old one; staying is always legal."""
    if new is not old and new not in LEGAL[old]:
        raise IllegalTransition(old, new)
    return new


@dataclass(frozen=True, slots=True)
class Conditions:
    """Everything the next mode depends on.

    person: a skeleton is there, or was a moment ago. tracked: it is there now, or lost for less than the hold time.
    engaged: somebody is in control. stopped: e-stop latched or forearms crossed. engage_reason, stop_reason and
    end_reason say why, for the events.
    """

    person: bool
    tracked: bool
    engaged: bool
    stopped: bool
    zone: Zone
    task: Mode | None
    engage_reason: Reason = Reason.ENGAGE_REQUEST
    stop_reason: Reason = Reason.ESTOP
    end_reason: Reason = Reason.PERSON_LEFT


_CRUISE: Final = {Zone.FORWARD: Mode.FORWARD, Zone.BACK: Mode.BACK, Zone.LEFT: Mode.LEFT, Zone.RIGHT: Mode.RIGHT}


def _wanted(c: Conditions) -> tuple[Mode, Reason]:
    """The mode the conditions ask for, whatever the present one."""
    if c.stopped:
        return Mode.STOPPED, c.stop_reason
    if not c.engaged:
        return (Mode.SEEN, c.end_reason) if c.person else (Mode.NO_PERSON, Reason.PERSON_LEFT)
    if not c.tracked:
        return Mode.HELD, Reason.TRACKING_LOST
    if c.zone is Zone.OUT:
        return Mode.HELD, Reason.OUT_OF_RANGE
    if c.zone in _CRUISE:
        return _CRUISE[c.zone], Reason.ZONE_ENTERED
    if c.zone is Zone.WORK and c.task is not None:
        return c.task, Reason.TASK_SETTLED
    return Mode.ENGAGED, Reason.TASK_UNSETTLED if c.zone is Zone.WORK else Reason.ZONE_UNSETTLED


def next_mode(mode: Mode, c: Conditions) -> tuple[tuple[Mode, Reason], ...]:
    """The modes passed through at this frame, with reasons, in order; empty when nothing changes.

    The way is always legal: into motion through SEEN and ENGAGED, out of STOPPED through SEEN.
    """
    wanted, reason = _wanted(c)
    steps: list[tuple[Mode, Reason]] = []
    while mode is not wanted:
        if wanted in LEGAL[mode]:
            step, why = wanted, reason
        elif mode in (Mode.NO_PERSON, Mode.STOPPED):
            step, why = Mode.SEEN, Reason.RESUMED
        else:
            step, why = Mode.ENGAGED, Reason.RESUMED if mode is Mode.HELD else reason
        if mode is Mode.NO_PERSON and step is Mode.SEEN:
            why = Reason.PERSON_SEEN
        if mode is Mode.SEEN and step is Mode.ENGAGED:
            why = c.engage_reason
        mode = transition(mode, step)
        steps.append((mode, why))
    return tuple(steps)
