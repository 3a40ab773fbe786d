"""Why a fruit is not picked: a value, since it is expected now and then."""

from __future__ import annotations

from dataclasses import dataclass

from robot_sim.reasons import RobotReason


@dataclass(frozen=True, slots=True)
class Refusal:
    """detail: what is in the way and what to do, in one sentence. forward_m: the drive that would help."""

    reason: RobotReason
    detail: str
    forward_m: float | None = None
