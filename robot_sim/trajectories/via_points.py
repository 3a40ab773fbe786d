"""Smooth motion through via points, at rest at both ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.interpolate import BPoly, CubicSpline, PPoly

from robot_sim.errors import RobotError
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.trajectories.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class ViaPoints(Trajectory):
    """A piecewise polynomial through the points; its second derivative is continuous."""

    curve: PPoly

    @property
    def duration_s(self) -> float:
        return float(self.curve.x[-1])

    def _evaluate(self, t_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        return self.curve(t_s), self.curve(t_s, 1), self.curve(t_s, 2)


def via_points(points: npt.ArrayLike, times_s: npt.ArrayLike, order: int = 5) -> ViaPoints:
    """Motion through points (K, n) at times (K,), times_s[0] = 0, with zero end speeds.

    order 3: the clamped cubic spline. order 5: quintics with that spline's speeds and accelerations at the inner
    points and zero acceleration at both ends, so that the arm starts and stops without a jerk.
    """
    q, t = np.asarray(points, dtype=np.float64), np.asarray(times_s, dtype=np.float64)
    if q.ndim != 2 or len(q) < 2 or t.shape != (len(q),) or t[0] != 0 or not (np.diff(t) > 0).all():
        raise RobotError(f"via points need (K, n) values and K rising times from 0, got {q.shape} and times {t}")
    if order not in (3, 5):
        raise RobotError(f"via points come as order 3 or 5, not {order}")
    spline = CubicSpline(t, q, bc_type="clamped")
    if order == 3:
        return ViaPoints(PPoly(spline.c, spline.x))
    acc = spline(t, 2)
    acc[0] = acc[-1] = 0.0
    knots = np.stack([q, spline(t, 1), acc], axis=1)
    return ViaPoints(PPoly.from_bernstein_basis(BPoly.from_derivatives(t, knots)))
