"""What happened to the crop and the robot, one frozen event each."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class RobotEventKind(StrEnum):
    """What an event tells."""

    CUT = "cut"
    BOXED = "boxed"
    DROPPED = "dropped"
    DAMAGED = "damaged"
    ARM_CONTACT = "arm_contact"
    OBSTACLE = "obstacle"
    TANK_EMPTY = "tank_empty"


@dataclass(frozen=True, slots=True)
class RobotEvent:
    """t_s: simulated time [s]. subject: the fruit, the two links, the liquid."""

    t_s: float
    kind: RobotEventKind
    subject: str
