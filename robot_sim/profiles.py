"""One tick of all driven joints towards their goals, each with a trapezoidal speed profile of its own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from robot_sim.actuators import axes
from robot_sim.config import RobotConfig
from robot_sim.derived import derived

F64 = npt.NDArray[np.float64]
_V = "float64[::1]"


@njit(f"void({_V}, {_V}, {_V}, {_V}, {_V}, {_V}, {_V}, float64)", cache=True, nogil=True)
def _advance(p, v, goal, lower, upper, speed, acceleration, dt):  # type: ignore[no-untyped-def]
    """Positions and speeds (n,) one tick on, in place; a goal that is not a number brakes."""
    for i in range(len(p)):
        a = acceleration[i] * dt
        if np.isnan(goal[i]):
            v[i] = 0.0 if abs(v[i]) <= a else v[i] - np.copysign(a, v[i])
            p[i] = min(max(p[i] + v[i] * dt, lower[i]), upper[i])
            continue
        error = goal[i] - p[i]
        if abs(error) <= a * dt and abs(v[i]) <= a:
            p[i], v[i] = goal[i], 0.0
            continue
        # n ticks of braking from n*a cover a*dt*n*(n+1)/2; solved for the speed n*a that covers the error
        most = 0.5 * a * (np.sqrt(1.0 + 8.0 * abs(error) / (a * dt)) - 1.0)
        most = min(most, speed[i])
        if most * dt > abs(error):
            most = abs(error) / dt
        v[i] = min(max(np.copysign(most, error), v[i] - a), v[i] + a)
        p[i] = min(max(p[i] + v[i] * dt, lower[i]), upper[i])


@dataclass(frozen=True, slots=True, eq=False)
class JointLimits:
    """Range, highest speed and acceleration of the driven joints, each (n,) in the order of JOINTS."""

    lower: F64
    upper: F64
    speed: F64
    acceleration: F64


@derived
def joint_limits(config: RobotConfig) -> JointLimits:
    """The limits of a robot's joints as arrays."""
    limits = [axis.limits for axis in axes(config)]
    return JointLimits(
        *(np.array([getattr(one, name) for one in limits]) for name in ("lower", "upper", "speed", "acceleration"))
    )


def advance_joints(position: F64, velocity: F64, goal: F64, dt_s: float, config: RobotConfig) -> tuple[F64, F64]:
    """Positions and speeds (n,) one tick of ``dt_s`` on; goal (n,): nan where a joint shall come to rest.

    Every joint takes the fastest speed from which braking in whole ticks still ends at its goal.
    """
    q, v, m = position.copy(), velocity.copy(), joint_limits(config)
    _advance(q, v, goal, m.lower, m.upper, m.speed, m.acceleration, dt_s)
    return q, v
