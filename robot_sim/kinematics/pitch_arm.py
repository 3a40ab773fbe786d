"""Closed-form inverse of a five-joint arm: yaw, three parallel pitch joints, roll (the plantlet arm).

Modified D-H twists 0, -90, 0, 0, -90 deg; lengths d1, a1, a2, a3, d5. Up to four branches: two shoulders x two elbows.
Only poses whose approach axis lies in the arm's vertical plane can be had; others come back as ``ik.orientation``.
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
from robot_sim.kinematics.transforms import FloatArray

_FREE = 1e-10
_NAMED = 1e-6


@njit(cache=True, nogil=True)
def _roots(T: np.ndarray, lengths: np.ndarray, ref: np.ndarray, q: np.ndarray, singular: np.ndarray) -> None:
    """Branches of T (N, 4, 4), last link in base axes, into q (N, 4, 5) and singular (N,)."""
    d1, a1, a2, a3, d5 = lengths
    for k in range(len(T)):
        q[k] = math.nan
        nx, ny, nz = T[k, 0, 0], T[k, 1, 0], T[k, 2, 0]
        ax, ay, az = T[k, 0, 2], T[k, 1, 2], T[k, 2, 2]
        wx, wy, wz = T[k, 0, 3] - d5 * ax, T[k, 1, 3] - d5 * ay, T[k, 2, 3] - d5 * az
        r = math.hypot(wx, wy)
        t1_first = math.atan2(wy, wx)
        if r < _NAMED * a2:
            singular[k] |= 1
            if r < _FREE:  # on the yaw axis: the approach still fixes the plane unless it is vertical too
                t1_first = math.atan2(ay, ax) if math.hypot(ax, ay) > _FREE else ref[0]
        b = 0
        for shoulder in range(2):
            t1 = t1_first + (math.pi if shoulder else 0.0)
            c1, s1 = math.cos(t1), math.sin(t1)
            x, y = c1 * wx + s1 * wy - a1, d1 - wz
            c3 = (x * x + y * y - a2 * a2 - a3 * a3) / (2.0 * a2 * a3)
            if abs(c3) > 1.0 + 1e-12:
                b += 2
                continue
            s3 = math.sqrt(max(0.0, 1.0 - c3 * c3))
            if s3 < _NAMED:
                singular[k] |= 2
            pitch = math.atan2(-(c1 * ax + s1 * ay), -az)
            cp, sp = math.cos(pitch), math.sin(pitch)
            t5 = math.atan2(s1 * nx - c1 * ny, cp * (c1 * nx + s1 * ny) - sp * nz)
            for elbow in range(2):
                t3 = math.atan2(s3 if elbow == 0 else -s3, c3)
                u, v = a2 + a3 * math.cos(t3), a3 * math.sin(t3)
                if u * u + v * v < _FREE * _FREE:  # folded back onto the shoulder
                    singular[k] |= 1
                    t2 = ref[1]
                else:
                    t2 = math.atan2(y, x) - math.atan2(v, u)
                q[k, b, 0], q[k, b, 1], q[k, b, 2] = t1, t2, t3
                q[k, b, 3], q[k, b, 4] = pitch - t2 - t3, t5
                b += 1


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
    T, q, singular = np.empty((1, 4, 4)), np.empty((1, 4, 5)), np.zeros(1, np.int8)
    if not last_link(T_base_tool, T_tool_last, T):
        return None
    _roots(T, lengths, ref, q, singular)
    return answer(fixed, slides, T_base_tool, ref, limits, tolerance, q, singular)


@dataclass(frozen=True, eq=False)
class PitchArm(ClosedFormArm):
    """Yaw, pitch, pitch, pitch, roll. lengths_m: (d1, a1, a2, a3, d5)."""

    lengths_m: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)

    @classmethod
    def from_lengths(
        cls,
        name: str,
        lengths_m: tuple[float, float, float, float, float],
        joints: Sequence[Joint],
        T_last_tool: FloatArray | None = None,
    ) -> PitchArm:
        """Arm with lengths (d1, a1, a2, a3, d5), five joints and a tool. Raises RobotError on a zero-length link."""
        d1, a1, a2, a3, d5 = lengths_m
        if a2 <= 0 or a3 <= 0 or len(joints) != 5:
            raise RobotError(f"{name}: needs five joints and a2, a3 > 0; got {lengths_m}")
        tool = np.eye(4) if T_last_tool is None else T_last_tool
        h = math.pi / 2
        shape = ((0.0, 0.0, d1), (-h, a1, 0.0), (0.0, a2, 0.0), (0.0, a3, 0.0), (-h, 0.0, d5))
        rows = [DhRow(al, a, d, 0.0, j) for (al, a, d), j in zip(shape, joints, strict=True)]
        return cls(modified_dh(name, rows, tool), tool, lengths_m=lengths_m)

    def _branches(self, T_base_last: FloatArray, ref: FloatArray) -> tuple[FloatArray, npt.NDArray[np.int8]]:
        q, singular = np.empty((len(T_base_last), 4, 5)), np.zeros(len(T_base_last), np.int8)
        _roots(T_base_last, self._lengths, ref, q, singular)
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
        d1, a1, a2, a3, d5 = self.lengths_m
        w = T_base_last[:3, 3] - d5 * T_base_last[:3, 2]
        r = math.hypot(w[0], w[1])
        reach = math.hypot(r - a1, w[2] - d1)
        off = 0.0 if r == 0 else abs(float(T_base_last[0, 2] * w[1] - T_base_last[1, 2] * w[0])) / r
        lean_deg = math.degrees(math.asin(min(1.0, off)))
        return (
            f"the wrist centre is {reach:.3f} m from the shoulder (the arm covers {abs(a2 - a3):.3f} to "
            f"{a2 + a3:.3f} m) and the approach axis leans {lean_deg:.3f} deg out of the arm's plane (0 is possible)"
        )
