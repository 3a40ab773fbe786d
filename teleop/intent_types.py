"""The words of intent: zones, modes, hands, angles, events; frozen types only."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Literal

Side = Literal["right", "left"]
SIDES: tuple[Side, Side] = ("right", "left")


class Zone(StrEnum):
    """Where the operator stands (specification, section 3). NONE: no spine; OUT: outside all zones."""

    NONE = "none"
    OUT = "out"
    FORWARD = "forward"
    WORK = "work"
    BACK = "back"
    LEFT = "left"
    RIGHT = "right"


class Mode(StrEnum):
    """The intent state machine's states."""

    NO_PERSON = "no_person"
    SEEN = "seen"
    ENGAGED = "engaged"
    PICKING = "picking"
    SPRAYING = "spraying"
    FORWARD = "forward"
    BACK = "back"
    LEFT = "left"
    RIGHT = "right"
    HELD = "held"
    STOPPED = "stopped"


class Hand(StrEnum):
    """What a hand shows."""

    OPEN = "open"
    FIST = "fist"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class ArmAngles:
    """theta1..theta3 of one arm in degrees, continuous; None where there is no answer (eq. 17, 18, 21)."""

    theta1_deg: float | None
    theta2_deg: float | None
    theta3_deg: float | None


@dataclass(frozen=True, slots=True)
class BodyAngles:
    """All angles the source takes from a skeleton, in degrees; T1 and T2 after eq. (8)-(13)."""

    right: ArmAngles
    left: ArmAngles
    T1_deg: float | None
    T2_deg: float | None


@dataclass(frozen=True, slots=True)
class Hands:
    """Both hands with confidence 0..1."""

    right: Hand = Hand.UNKNOWN
    left: Hand = Hand.UNKNOWN
    right_confidence: float = 0.0
    left_confidence: float = 0.0


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happened once, with the reason code; never dropped on the way to the console."""

    t_ns: int
    kind: str
    reason: str
    detail: str = ""


@dataclass(frozen=True, slots=True)
class Intent:
    """What the operator wants, before safety has its say. Times in ns, angles in degrees."""

    t_ns: int
    zone: Zone
    mode: Mode
    angles: BodyAngles
    hands: Hands
    spine_xz_m: tuple[float, float] | None
    engage_progress: float = 0.0
    reasons: tuple[str, ...] = ()
    events: tuple[Event, ...] = field(default=())
