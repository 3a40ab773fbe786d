"""Motions in time: polynomials, trapezoids, via points, Cartesian lines, time scaling; sampled at any rate."""

from robot_sim.trajectories.cartesian import DriveLine, LineResult, follow_line
from robot_sim.trajectories.limits import LimitBreach, TimeScaled, find_breaches, slowed_to_limits
from robot_sim.trajectories.polynomial import Polynomial, cubic, quintic
from robot_sim.trajectories.trajectory import Motion, Sequence, Trajectory
from robot_sim.trajectories.trapezoid import Trapezoid, trapezoid
from robot_sim.trajectories.via_points import ViaPoints, via_points

__all__ = [
    "DriveLine",
    "LimitBreach",
    "LineResult",
    "Motion",
    "Polynomial",
    "Sequence",
    "TimeScaled",
    "Trajectory",
    "Trapezoid",
    "ViaPoints",
    "cubic",
    "find_breaches",
    "follow_line",
    "quintic",
    "slowed_to_limits",
    "trapezoid",
    "via_points",
]
