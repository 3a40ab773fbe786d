"""A servo controller in software, for a pseudo-terminal: answers the protocol, stops by its own watchdog. Pure."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from robot_sim.actuators import axes
from robot_sim.config import RobotConfig
from robot_sim.link.servo_protocol import (
    Move,
    Reply,
    Request,
    channel_value,
    decode_request,
    encode_reply,
)

WATCHDOG_S = 0.5


@dataclass(frozen=True, slots=True)
class Controller:
    """What a controller remembers. servos: channel -> whole degrees or mm. last: the request it answered last."""

    servos: dict[int, int] = field(default_factory=dict)
    left_mm_s: int = 0
    right_mm_s: int = 0
    valve: int = -1
    stopped: bool = False
    heard_s: float = 0.0
    last: Request | None = None
    answer: Reply | None = None
    done: int = 0
    """How many requests were carried out; a repeated one counts once."""


def hear(controller: Controller, line: bytes, now_s: float, config: RobotConfig) -> tuple[Controller, bytes]:
    """Take one line; returns the controller after it and its answer."""
    request = decode_request(line)
    if isinstance(request, str):
        # whose line it was cannot be trusted: the number 0 and the fault
        return controller, encode_reply(Reply(_number(line), request))
    controller = replace(controller, heard_s=now_s)
    if request == controller.last and controller.answer is not None:
        return controller, encode_reply(controller.answer)
    error = ""
    if request.verb == "X":
        controller = replace(controller, stopped=True, left_mm_s=0, right_mm_s=0, valve=-1)
    elif request.verb == "R":
        controller = replace(controller, stopped=False)
    elif request.move is not None:
        error = _refusal(request.move, config)
        if not error:
            controller = _moved(controller, request.move)
    answer = Reply(request.sequence, error)
    return replace(controller, last=request, answer=answer, done=controller.done + 1), encode_reply(answer)


def watch(controller: Controller, now_s: float) -> Controller:
    """Nobody spoke for half a second: tracks and valve off, servos hold."""
    if now_s - controller.heard_s <= WATCHDOG_S:
        return controller
    return replace(controller, left_mm_s=0, right_mm_s=0, valve=-1)


def _moved(controller: Controller, move: Move) -> Controller:
    if controller.stopped:
        return controller
    return replace(
        controller,
        servos=controller.servos | dict(move.servos),
        left_mm_s=move.left_mm_s,
        right_mm_s=move.right_mm_s,
        valve=move.valve,
    )


def _refusal(move: Move, config: RobotConfig) -> str:
    all_axes = axes(config)
    for channel, value in move.servos.items():
        axis = all_axes[channel]
        low, high = (channel_value(axis.name, q) for q in (axis.limits.lower, axis.limits.upper))
        if not low <= value <= high:
            return "range"
    return ""


def _number(line: bytes) -> int:
    """The number a damaged line seems to bear, 0 when it cannot be read; its sender compares."""
    digits = line[1:].split(b",", 1)[0]
    return int(digits) % 1000 if digits.isdigit() else 0
