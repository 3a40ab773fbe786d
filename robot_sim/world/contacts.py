"""What touching something solid forbids the chassis: no speed that presses further into it. Pure."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import cos, sin

from robot_sim.limiter import Goals
from robot_sim.reasons import RobotReason

PRESSING_M_S = 1e-3


@dataclass(frozen=True, slots=True)
class Touch:
    """One contact with the surroundings, in world axes: where [m] and the unit normal towards the robot."""

    x_m: float
    y_m: float
    normal_x: float
    normal_y: float


def away_from(touches: Iterable[Touch], goals: Goals, x_m: float, y_m: float, yaw_rad: float) -> Goals:
    """The goals without a drive or turn speed that would press into a contact; says so with ``stop.contact``.

    x_m, y_m, yaw_rad: the chassis. Speeds that lead away from every contact stay.
    """
    drive, turn = goals.drive_m_s, goals.turn_rad_s
    touched = False
    for touch in touches:
        touched = True
        if drive * (cos(yaw_rad) * touch.normal_x + sin(yaw_rad) * touch.normal_y) < -PRESSING_M_S:
            drive = 0.0
        # velocity of the touching point when turning about the middle: turn x r
        rx, ry = touch.x_m - x_m, touch.y_m - y_m
        if turn * (rx * touch.normal_y - ry * touch.normal_x) < -PRESSING_M_S:
            turn = 0.0
    if not touched:
        return goals
    reasons = tuple(dict.fromkeys((*goals.reasons, RobotReason.CONTACT)))
    return replace(goals, drive_m_s=drive, turn_rad_s=turn, reasons=reasons)
