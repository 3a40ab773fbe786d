"""Cubic and quintic point-to-point motion; all joints leave and arrive together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robot_sim.kinematics.transforms import FloatArray
from robot_sim.trajectories.trajectory import Trajectory, check_ends


@dataclass(frozen=True, eq=False)
class Polynomial(Trajectory):
    """coefficients (k, n): a0, a1, ... of q(t) = sum a_i t^i, t in s."""

    coefficients: FloatArray
    length_s: float

    @property
    def duration_s(self) -> float:
        return self.length_s

    def _evaluate(self, t_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        powers = np.arange(len(self.coefficients))
        a = self.coefficients
        da = a[1:] * powers[1:, None]
        dda = da[1:] * powers[1:-1, None]
        q, qd, qdd = (t_s[:, None] ** np.arange(len(c)) @ c for c in (a, da, dda))
        return q, qd, qdd


def _speeds(v: npt.ArrayLike | None, like: FloatArray) -> FloatArray:
    return np.zeros_like(like) if v is None else np.broadcast_to(np.asarray(v, dtype=np.float64), like.shape)


def cubic(
    q0: npt.ArrayLike,
    qf: npt.ArrayLike,
    duration_s: float,
    v0: npt.ArrayLike | None = None,
    vf: npt.ArrayLike | None = None,
) -> Polynomial:
    """Cubic with end speeds, zero by default (the grape source's (8)-(10)).

    Its acceleration is not zero at the ends, as the source's (7) asks: a cubic has no freedom left for that.
    """
    a, b = check_ends(q0, qf, duration_s)
    u, w = _speeds(v0, a), _speeds(vf, a)
    T, D = duration_s, b - a
    return Polynomial(np.stack([a, u, 3 * D / T**2 - (2 * u + w) / T, -2 * D / T**3 + (u + w) / T**2]), T)


def quintic(
    q0: npt.ArrayLike,
    qf: npt.ArrayLike,
    duration_s: float,
    v0: npt.ArrayLike | None = None,
    vf: npt.ArrayLike | None = None,
    acc0: npt.ArrayLike | None = None,
    accf: npt.ArrayLike | None = None,
) -> Polynomial:
    """Quintic with end speeds and accelerations, zero by default (the plantlet source's (4), (5))."""
    a, b = check_ends(q0, qf, duration_s)
    u, w, s, e = _speeds(v0, a), _speeds(vf, a), _speeds(acc0, a), _speeds(accf, a)
    T, D = duration_s, b - a
    a3 = (20 * D - (8 * w + 12 * u) * T - (3 * s - e) * T**2) / (2 * T**3)
    a4 = (-30 * D + (14 * w + 16 * u) * T + (3 * s - 2 * e) * T**2) / (2 * T**4)
    a5 = (12 * D - 6 * (w + u) * T - (s - e) * T**2) / (2 * T**5)
    return Polynomial(np.stack([a, u, s / 2, a3, a4, a5]), T)
