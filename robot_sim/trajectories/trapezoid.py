"""Point-to-point motion with a trapezoidal speed profile, straight in joint space, inside all limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robot_sim.errors import RobotError
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.trajectories.trajectory import Trajectory, check_ends


@dataclass(frozen=True, eq=False)
class Trapezoid(Trajectory):
    """q0 + s(t) (qf - q0): s accelerates for ramp_s, cruises, brakes for ramp_s."""

    q0: FloatArray
    qf: FloatArray
    ramp_s: float
    length_s: float

    @property
    def duration_s(self) -> float:
        return self.length_s

    def _evaluate(self, t_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        r, T = self.ramp_s, self.length_s
        D = (self.qf - self.q0)[None, :]
        if T == 0.0:  # nothing to move
            zero = np.zeros((len(t_s), len(self.q0)))
            return zero + self.q0, zero, zero
        peak = 1.0 / (T - r)
        acc = peak / r
        left = T - t_s
        rising, falling = t_s < r, left < r
        s = np.where(rising, 0.5 * acc * t_s**2, np.where(falling, 1 - 0.5 * acc * left**2, peak * (t_s - r / 2)))
        ds = np.where(rising, acc * t_s, np.where(falling, acc * left, peak))
        dds = np.where(rising, acc, np.where(falling, -acc, 0.0))
        return self.q0 + s[:, None] * D, ds[:, None] * D, dds[:, None] * D


def trapezoid(q0: npt.ArrayLike, qf: npt.ArrayLike, speed: npt.ArrayLike, acceleration: npt.ArrayLike) -> Trapezoid:
    """The quickest such motion with |qd| <= speed and |qdd| <= acceleration, each (n,) or one value, rad/s, rad/s^2."""
    a, b = check_ends(q0, qf, 1.0)
    v, acc = (np.broadcast_to(np.asarray(x, dtype=np.float64), a.shape) for x in (speed, acceleration))
    if not ((v > 0).all() and (acc > 0).all()):
        raise RobotError("speed and acceleration limits must be positive")
    D = np.abs(b - a)
    moving = D > 1e-12  # less is rounding, not motion
    if not moving.any():
        return Trapezoid(a, b, 0.0, 0.0)
    ds = float((v[moving] / D[moving]).min())  # limits of the path parameter
    dds = float((acc[moving] / D[moving]).min())
    ramp = min(ds / dds, np.sqrt(1.0 / dds))  # short motions never cruise
    peak = dds * ramp
    return Trapezoid(a, b, float(ramp), float(1.0 / peak + ramp))
