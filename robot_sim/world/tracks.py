"""From drive and turn speed to the two tracks' speeds, with the heading held by a gyro. Pure."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, remainder

from robot_sim.config import ChassisConfig
from robot_sim.urdf_parts_chassis import track_offset_m

MOST_HEADING_ERROR_RAD = 0.12


@dataclass(frozen=True, slots=True)
class Heading:
    """The heading the gyro holds [rad], in the same turn as the measured one."""

    wanted_rad: float


def track_speeds(
    heading: Heading, yaw_rad: float, drive_m_s: float, turn_rad_s: float, dt_s: float, chassis: ChassisConfig
) -> tuple[Heading, float, float]:
    """Next heading to hold, and the left and right track's speed over the floor [m/s].

    A crawler scrubs when it turns, so the tracks' speeds alone do not fix the turning rate: the error of the
    measured heading is fed back. At rest both tracks are braked and the heading is taken as it is.
    """
    if drive_m_s == 0.0 and turn_rad_s == 0.0:
        return Heading(yaw_rad), 0.0, 0.0
    error = remainder(heading.wanted_rad + turn_rad_s * dt_s - yaw_rad, 2.0 * pi)
    # pushed aside or blocked: do not wind up
    error = min(max(error, -MOST_HEADING_ERROR_RAD), MOST_HEADING_ERROR_RAD)
    turn = turn_rad_s + chassis.heading_gain_1_s * error
    half = track_offset_m(chassis)
    return Heading(yaw_rad + error), drive_m_s - turn * half, drive_m_s + turn * half
