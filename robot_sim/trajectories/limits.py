"""Limits of a trajectory: where they are broken, and the same path slowed until they hold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robot_sim.errors import RobotError
from robot_sim.kinematics.chain import Chain
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.trajectories.trajectory import Trajectory


@dataclass(frozen=True, slots=True)
class LimitBreach:
    """One joint that leaves its range or breaks its speed limit; value is the worst one met, at t_s."""

    joint: str
    what: str
    t_s: float
    value: float
    limit: float


def find_breaches(trajectory: Trajectory, chain: Chain, step_s: float = 0.005) -> tuple[LimitBreach, ...]:
    """Position and speed limits of the chain that the trajectory breaks, each joint's worst sample."""
    m = trajectory.sample(step_s)
    found = []
    for i, j in enumerate(chain.joints):
        for what, value, limit, over in (
            ("lower limit", m.q[:, i], j.lower, j.lower - m.q[:, i]),
            ("upper limit", m.q[:, i], j.upper, m.q[:, i] - j.upper),
            ("speed", m.qd[:, i], j.speed, np.abs(m.qd[:, i]) - j.speed),
        ):
            k = int(np.argmax(over))
            if over[k] > 1e-9:
                found.append(LimitBreach(j.name, what, float(m.t_s[k]), float(value[k]), float(limit)))
    return tuple(found)


@dataclass(frozen=True, eq=False)
class TimeScaled(Trajectory):
    """The same path, slowed by a constant factor: speeds fall by it, accelerations by its square."""

    inner: Trajectory
    factor: float

    @property
    def duration_s(self) -> float:
        return self.inner.duration_s * self.factor

    def _evaluate(self, t_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        m = self.inner.at(t_s / self.factor)
        return m.q, m.qd / self.factor, m.qdd / self.factor**2


def slowed_to_limits(
    trajectory: Trajectory,
    speed: npt.ArrayLike,
    acceleration: npt.ArrayLike = np.inf,
    step_s: float = 0.002,
) -> TimeScaled:
    """The trajectory with the least slowing (factor >= 1) at which its samples keep speed and acceleration limits.

    speed, acceleration: (n,) or one value, rad/s and rad/s^2.
    """
    v, a = np.asarray(speed, dtype=np.float64), np.asarray(acceleration, dtype=np.float64)
    if not ((v > 0).all() and (a > 0).all()):
        raise RobotError("speed and acceleration limits must be positive")
    m = trajectory.sample(step_s)
    by_speed = float((np.abs(m.qd) / v).max())
    by_acceleration = float(np.sqrt((np.abs(m.qdd) / a).max()))
    return TimeScaled(trajectory, max(1.0, by_speed, by_acceleration))
