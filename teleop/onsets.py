"""Reason codes as events: one when a clamp, hold, refusal or stop begins, none while it lasts. Pure."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final

from teleop.intent_types import Event

QUIET_S: Final = 1.0
"""A code that was away for so long begins anew: what flickers is told once, not at every frame."""
ROUTINE: Final = frozenset(
    {
        "limit.joint_speed",
        "limit.chassis_acceleration",
        "hold.arm_locked",
        "hold.hand_not_changed",
        "hold.not_engaged",
        "stop.no_person",
    }
)
"""Part of every motion, task or idle moment: state and recording carry them, events would drown in them."""
KINDS: Final = frozenset({"hold", "stop", "refused", "limit"})


@dataclass(frozen=True, slots=True)
class Onsets:
    """When each code was last in force [s], and which were at the last step."""

    codes: frozenset[str] = frozenset()
    last_s: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))


def step_onsets(
    onsets: Onsets, codes: Iterable[str], told: Iterable[Event], t_ns: int, now_s: float
) -> tuple[tuple[Event, ...], Onsets]:
    """One step: events for codes that begin now and that no event of this step tells already.

    codes: all in force. now_s: any clock that runs on. Returns the events and the next memory.
    """
    known = {str(event.reason) for event in told}
    events: list[Event] = []
    # a step that comes late, on a busy machine, makes nothing begin anew
    last = {c: seen for c, seen in onsets.last_s.items() if c in onsets.codes or now_s - seen < QUIET_S}
    now = dict.fromkeys(map(str, codes))
    for code in now:
        kind = code.partition(".")[0]
        if kind in KINDS and code not in ROUTINE and code not in last and code not in known:
            events.append(Event(t_ns, kind, code))
        last[code] = now_s
    return tuple(events), Onsets(frozenset(now), MappingProxyType(last))
