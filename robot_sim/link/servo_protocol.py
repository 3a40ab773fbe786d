"""The servo controller's ASCII protocol (docs/servo_protocol.md): text lines in, messages out. Pure.

A request is ``$SEQ,VERB[,FIELD]*CC`` and its answer ``!SEQ,OK`` or ``!SEQ,ER,WHY`` with the same ending, each closed by
a line feed; CC is the exclusive or of all characters between the first one and ``*`` in two hexadecimal digits, as in
NMEA 0183. Angles travel as whole degrees, as the source sends them, lengths as whole millimetres.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import reduce
from math import degrees, radians
from typing import Literal

from robot_sim.actuators import JOINTS

SEQUENCES = 1000
"""Sequence numbers run from 0 to 999 and start again."""
LONGEST_LINE = 200
IN_MILLIMETRES = frozenset({"lift", "gripper_left", "gripper_right"})
Verb = Literal["M", "X", "R", "Q"]
VERBS: tuple[Verb, ...] = ("M", "X", "R", "Q")
"""Move, emergency stop, release of the emergency stop, query."""
NO_VALVE = -1


@dataclass(frozen=True, slots=True)
class Move:
    """Tracks [mm/s], open valve (0 water, 1 nutrient, 2 pesticide, NO_VALVE), channel -> whole degrees or mm."""

    left_mm_s: int = 0
    right_mm_s: int = 0
    valve: int = NO_VALVE
    servos: Mapping[int, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Request:
    """One line to the controller; move only with the verb M."""

    sequence: int
    verb: Verb
    move: Move | None = None


@dataclass(frozen=True, slots=True)
class Reply:
    """One line from the controller. error: empty when it did what it was told."""

    sequence: int
    error: str = ""


def checksum(text: str) -> str:
    """Exclusive or of all characters, two hexadecimal digits."""
    return f"{reduce(lambda a, c: a ^ ord(c), text, 0) & 0xFF:02X}"


def channel_value(joint: str, q: float) -> int:
    """A joint's position [rad or m] as the controller takes it: whole degrees, or millimetres."""
    return round(1000.0 * q) if joint in IN_MILLIMETRES else round(degrees(q))


def joint_position(joint: str, value: int) -> float:
    """The inverse of :func:`channel_value`."""
    return value / 1000.0 if joint in IN_MILLIMETRES else radians(value)


def encode_request(request: Request) -> bytes:
    """The line of a request."""
    fields = [str(request.sequence), request.verb]
    if request.move is not None:
        m = request.move
        fields += [str(m.left_mm_s), str(m.right_mm_s), str(m.valve)]
        fields += [f"{channel}={value}" for channel, value in sorted(m.servos.items())]
    return _line("$", ",".join(fields))


def encode_reply(reply: Reply) -> bytes:
    """The line of a reply."""
    return _line("!", f"{reply.sequence},ER,{reply.error}" if reply.error else f"{reply.sequence},OK")


def decode_request(line: bytes) -> Request | str:
    """A request, or why it is none: ``checksum``, ``format``, ``verb``, ``channel``."""
    body = _body(line, "$")
    if body is None:
        return "checksum"
    fields = body.split(",")
    sequence = _whole(fields[0], 0, SEQUENCES - 1)
    if sequence is None or len(fields) < 2:
        return "format"
    verb = next((v for v in VERBS if v == fields[1]), None)
    if verb is None:
        return "verb"
    if verb != "M":
        return Request(sequence, verb) if len(fields) == 2 else "format"
    speeds = [_whole(text, -9999, 9999) for text in fields[2:5]]
    if len(speeds) < 3:
        return "format"
    left, right, valve = speeds
    if left is None or right is None or valve not in (NO_VALVE, 0, 1, 2):
        return "format"
    servos: dict[int, int] = {}
    for text in fields[5:]:
        number, _, value = text.partition("=")
        channel, position = _whole(number, 0, len(JOINTS) - 1), _whole(value, -9999, 9999)
        if channel is None or position is None:
            return "channel"
        servos[channel] = position
    return Request(sequence, verb, Move(left, right, valve, servos))


def decode_reply(line: bytes) -> Reply | None:
    """A reply, or None when the line was damaged on its way."""
    body = _body(line, "!")
    if body is None:
        return None
    fields = body.split(",")
    sequence = _whole(fields[0], 0, SEQUENCES - 1)
    if sequence is None:
        return None
    if fields[1:] == ["OK"]:
        return Reply(sequence)
    return Reply(sequence, fields[2]) if len(fields) == 3 and fields[1] == "ER" else None


def _line(begin: str, body: str) -> bytes:
    return f"{begin}{body}*{checksum(body)}\n".encode("ascii")


def _body(line: bytes, begin: str) -> str | None:
    """What stands between the first character and the checksum, or None when the line is damaged."""
    try:
        text = line.decode("ascii").rstrip("\r\n")
    except UnicodeDecodeError:
        return None
    body, star, told = text[1:].rpartition("*")
    return body if text[:1] == begin and star and told == checksum(body) else None


def _whole(text: str, low: int, high: int) -> int | None:
    # int() alone would take blanks, underscores and other scripts' digits
    if not (text.isascii() and text.removeprefix("-").isdigit()):
        return None
    value = int(text)
    return value if low <= value <= high else None
