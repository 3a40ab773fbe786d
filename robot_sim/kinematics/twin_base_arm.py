"""Closed-form inverse of the cherry-tomato arm, whose first two joints turn about one and the same axis.

Modified D-H rows (alpha, a, d): (0, 0, 0), (0, 0, d2), (90, 0, 0), (0, a3, 0), (90, a4, d5), tool (90, a6, 0);
they give the tomato source's eq. (2) with its misprints put right: py has s12 and -c12 s5, theta34 = arccos(-oz).
theta1 and theta2 enter only as their sum theta12: four independent joints and a line of solutions for each pose.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from numba import njit

from robot_sim.errors import RobotError
from robot_sim.kinematics.chain import Joint
from robot_sim.kinematics.closed_form import ClosedFormArm, OneAnswer, answer, last_link
from robot_sim.kinematics.dh import DhRow, modified_dh
from robot_sim.kinematics.transforms import FloatArray, rot_x, translation

_FREE = 1e-10
_NAMED = 1e-6


@njit(cache=True, nogil=True)
def split_sum(t12: float, ref1: float, ref2: float, limits: np.ndarray) -> tuple[float, float]:
    """theta1, theta2 inside limits (2, >=2) with theta1 + theta2 = t12 (mod 2 pi), least squared motion from the refs.

    Without limits both move by half the difference; a joint that meets its limit leaves the rest to the other.
    Returns NaN when no split fits.
    """
    best, t1_best, t2_best = math.inf, math.nan, math.nan
    first = t12 + 2.0 * math.pi * round((ref1 + ref2 - t12) / (2.0 * math.pi))
    for turn in range(-2, 3):
        total = first + 2.0 * math.pi * turn
        low = max(limits[0, 0], total - limits[1, 1])
        high = min(limits[1, 0], total - limits[0, 1])
        if low > high:
            continue
        t1 = min(max(ref1 + 0.5 * (total - ref1 - ref2), low), high)
        cost = (t1 - ref1) ** 2 + (total - t1 - ref2) ** 2
        if cost < best:
            best, t1_best, t2_best = cost, t1, total - t1
    return t1_best, t2_best


@njit(cache=True, nogil=True)
def _roots(
    T: np.ndarray, lengths: np.ndarray, ref: np.ndarray, limits: np.ndarray, q: np.ndarray, singular: np.ndarray
) -> None:
    """Branches of tool poses T (N, 4, 4) into q (N, 2, 5) and singular (N,)."""
    d2, a3, a4, d5, a6 = lengths
    for k in range(len(T)):
        q[k] = math.nan
        nx, ny, nz = T[k, 0, 0], T[k, 1, 0], T[k, 2, 0]
        ox, oy, oz = T[k, 0, 1], T[k, 1, 1], T[k, 2, 1]
        wx, wy, wz = T[k, 0, 3] - a6 * nx, T[k, 1, 3] - a6 * ny, T[k, 2, 3] - a6 * nz
        reach, fore = math.sqrt(wx * wx + wy * wy + (wz - d2) ** 2), math.hypot(a4, d5)
        if reach > a3 + fore + 1e-9 or reach < abs(a3 - fore) - 1e-9:
            continue
        s34_size = math.hypot(ox, oy)
        upright = s34_size < _FREE
        if s34_size < _NAMED:
            singular[k] |= 4
        for b in range(2):
            sign = 1.0 if b == 0 else -1.0
            if not upright:
                t12 = math.atan2(sign * oy, sign * ox)
            elif math.hypot(wx, wy) > _FREE:  # last axis parallel to the base axis: the position fixes theta12
                t12 = math.atan2(sign * wy, sign * wx)
            else:
                singular[k] |= 1
                t12 = ref[0] + ref[1]
            c12, s12 = math.cos(t12), math.sin(t12)
            t34 = math.atan2(c12 * ox + s12 * oy, -oz)
            c34, s34 = math.cos(t34), math.sin(t34)
            # n in the plane of the arm and across it
            t5 = math.atan2(s12 * nx - c12 * ny, c34 * (c12 * nx + s12 * ny) + s34 * nz)
            s3 = (wz - d2 + d5 * c34 - a4 * s34) / a3
            c3 = (c12 * wx + s12 * wy - a4 * c34 - d5 * s34) / a3
            t3 = math.atan2(s3, c3)
            t1, t2 = split_sum(t12, ref[0], ref[1], limits)
            if math.isnan(t1):
                t1, t2 = t12, 0.0
            q[k, b, 0], q[k, b, 1], q[k, b, 2], q[k, b, 3], q[k, b, 4] = t1, t2, t3, t34 - t3, t5


@njit(cache=True, nogil=True)
def _solve_one(
    T_base_tool: np.ndarray,
    T_tool_last: np.ndarray,
    fixed: np.ndarray,
    slides: np.ndarray,
    lengths: np.ndarray,
    ref: np.ndarray,
    limits: np.ndarray,
    tolerance: np.ndarray,
) -> OneAnswer | None:
    """One pose (4, 4) from check to answer."""
    T, q, singular = np.empty((1, 4, 4)), np.empty((1, 2, 5)), np.zeros(1, np.int8)
    if not last_link(T_base_tool, T_tool_last, T):
        return None
    _roots(T, lengths, ref, limits, q, singular)
    return answer(fixed, slides, T_base_tool, ref, limits, tolerance, q, singular)


@dataclass(frozen=True, eq=False)
class TwinBaseArm(ClosedFormArm):
    """The tomato arm. lengths_m: (d2, a3, a4, d5, a6)."""

    lengths_m: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)

    @classmethod
    def from_lengths(
        cls, name: str, lengths_m: tuple[float, float, float, float, float], joints: Sequence[Joint]
    ) -> TwinBaseArm:
        """Arm with lengths (d2, a3, a4, d5, a6), five joints; the tool is the source's own last frame."""
        d2, a3, a4, d5, a6 = lengths_m
        if a3 <= 0 or len(joints) != 5:
            raise RobotError(f"{name}: needs five joints and a3 > 0; got {lengths_m}")
        h = math.pi / 2
        shape = ((0.0, 0.0, 0.0), (0.0, 0.0, d2), (h, 0.0, 0.0), (0.0, a3, 0.0), (h, a4, d5))
        rows = [DhRow(al, a, d, 0.0, j) for (al, a, d), j in zip(shape, joints, strict=True)]
        tool = rot_x(h) @ translation(a6, 0.0, 0.0)
        return cls(modified_dh(name, rows, tool), np.eye(4), lengths_m=lengths_m)

    def _branches(self, T_base_last: FloatArray, ref: FloatArray) -> tuple[FloatArray, npt.NDArray[np.int8]]:
        q, singular = np.empty((len(T_base_last), 2, 5)), np.zeros(len(T_base_last), np.int8)
        _roots(T_base_last, self._lengths, ref, self._limits, q, singular)
        return q, singular

    def _solve(self, T_base_tool: FloatArray, ref: FloatArray) -> OneAnswer | None:
        found: OneAnswer | None = _solve_one(
            T_base_tool,
            self._T_tool_last,
            self.chain.fixed,
            self._slides,
            self._lengths,
            ref,
            self._limits,
            self._tolerance,
        )
        return found

    @cached_property
    def _lengths(self) -> FloatArray:
        return np.array(self.lengths_m)

    def _describe(self, T_base_last: FloatArray) -> str:
        d2, a3, a4, d5, a6 = self.lengths_m
        reach = float(np.linalg.norm(T_base_last[:3, 3] - a6 * T_base_last[:3, 0] - (0.0, 0.0, d2)))
        fore = math.hypot(a4, d5)
        return (
            f"the last joint is {reach:.3f} m from the shoulder (the arm covers {abs(a3 - fore):.3f} to "
            f"{a3 + fore:.3f} m); inside that, the pose must be of the arm's four-parameter family"
        )

    def theta1_range(self, t12_rad: float) -> tuple[float, float]:
        """Where theta1 may lie, rad, for one theta1 + theta2 inside the limits; the redundancy of the arm."""
        lower, upper = self.chain.lower, self.chain.upper
        return max(lower[0], t12_rad - upper[1]), min(upper[0], t12_rad - lower[1])
