"""Closed-form inverse of the six-joint arm with a spherical wrist (GSK RB03, the grape source's eq. (2), (3)).

Modified D-H twists 0, -90, 0, -90, 90, -90 deg; lengths a1, a2, a3, d4. Up to eight branches:
two shoulders x two elbows x two wrists.
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

_FREE = 1e-10  # below this a direction is not defined and the joint is taken from the reference
_NAMED = 1e-6  # below this (sine, or share of the arm's length) the pose is called singular


@njit(cache=True, nogil=True)
def _roots(
    T: np.ndarray, a1: float, a2: float, a3: float, d4: float, ref: np.ndarray, q: np.ndarray, singular: np.ndarray
) -> None:
    """Branches of T (N, 4, 4), wrist frame in base axes, into q (N, 8, 6) and singular (N,)."""
    rho2 = a3 * a3 + d4 * d4
    for k in range(len(T)):
        q[k] = math.nan
        nx, ny, nz = T[k, 0, 0], T[k, 1, 0], T[k, 2, 0]
        ax, ay, az = T[k, 0, 2], T[k, 1, 2], T[k, 2, 2]
        px, py, pz = T[k, 0, 3], T[k, 1, 3], T[k, 2, 3]
        r = math.hypot(px, py)
        if r < _NAMED * a2:
            singular[k] |= 1
        b = 0
        for shoulder in range(2):
            t1 = (math.atan2(py, px) if r > _FREE else ref[0]) + (math.pi if shoulder else 0.0)
            c1, s1 = math.cos(t1), math.sin(t1)
            x = c1 * px + s1 * py - a1
            # the source's k; its a3 + d4 - k under the root must be a3^2 + d4^2 - k^2
            kk = (x * x + pz * pz - a2 * a2 - rho2) / (2.0 * a2)
            root2 = rho2 - kk * kk
            if root2 < -1e-12 * rho2:
                b += 4
                continue
            if root2 < _NAMED * _NAMED * rho2:
                singular[k] |= 2
            root = math.sqrt(max(root2, 0.0))
            for elbow in range(2):
                t3 = math.atan2(a3, d4) - math.atan2(kk, root if elbow == 0 else -root)
                c3, s3 = math.cos(t3), math.sin(t3)
                A, B = a2 + a3 * c3 - d4 * s3, -(a3 * s3 + d4 * c3)
                if A * A + B * B < _FREE * _FREE:  # wrist centre on the shoulder axis: theta2 is free
                    singular[k] |= 1
                    t2 = ref[1]
                else:
                    t2 = math.atan2(B * x - A * pz, A * x + B * pz)
                c23, s23 = math.cos(t2 + t3), math.sin(t2 + t3)
                # approach a in frame 3: (-c4 s5, c5, s4 s5)
                a_x = c23 * (c1 * ax + s1 * ay) - s23 * az
                a_y = -s23 * (c1 * ax + s1 * ay) - c23 * az
                a_z = -s1 * ax + c1 * ay
                s5 = math.hypot(a_x, a_z)
                if s5 < _NAMED:
                    singular[k] |= 4
                n_x = c23 * (c1 * nx + s1 * ny) - s23 * nz
                n_y = -s23 * (c1 * nx + s1 * ny) - c23 * nz
                n_z = -s1 * nx + c1 * ny
                for wrist in range(2):
                    t4 = math.atan2(a_z, -a_x) if s5 > _FREE else ref[3]
                    if wrist:
                        t4 += math.pi
                    c4, s4 = math.cos(t4), math.sin(t4)
                    t5 = math.atan2(-a_x * c4 + a_z * s4, a_y)
                    c5, s5w = math.cos(t5), math.sin(t5)
                    n_x4 = c4 * n_x - s4 * n_z
                    t6 = math.atan2(-s4 * n_x - c4 * n_z, c5 * n_x4 + s5w * n_y)
                    q[k, b, 0], q[k, b, 1], q[k, b, 2] = t1, t2, t3
                    q[k, b, 3], q[k, b, 4], q[k, b, 5] = t4, t5, t6
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
    T, q, singular = np.empty((1, 4, 4)), np.empty((1, 8, 6)), np.zeros(1, np.int8)
    if not last_link(T_base_tool, T_tool_last, T):
        return None
    _roots(T, lengths[0], lengths[1], lengths[2], lengths[3], ref, q, singular)
    return answer(fixed, slides, T_base_tool, ref, limits, tolerance, q, singular)


@dataclass(frozen=True, eq=False)
class SphericalWristArm(ClosedFormArm):
    """Six revolute joints, the last three meeting in one point. Lengths in m."""

    a1_m: float = 0.0
    a2_m: float = 0.0
    a3_m: float = 0.0
    d4_m: float = 0.0

    @classmethod
    def from_lengths(
        cls,
        name: str,
        lengths_m: tuple[float, float, float, float],
        joints: Sequence[Joint],
        T_last_tool: FloatArray | None = None,
    ) -> SphericalWristArm:
        """Arm with lengths (a1, a2, a3, d4), six joints and a tool. Raises RobotError when it cannot fold."""
        a1, a2, a3, d4 = lengths_m
        if a2 <= 0 or math.hypot(a3, d4) <= 0 or len(joints) != 6:
            raise RobotError(f"{name}: needs six joints, a2 > 0 and a3, d4 not both zero; got {lengths_m}")
        tool = np.eye(4) if T_last_tool is None else T_last_tool
        h = math.pi / 2
        shape = ((0.0, 0.0, 0.0), (-h, a1, 0.0), (0.0, a2, 0.0), (-h, a3, d4), (h, 0.0, 0.0), (-h, 0.0, 0.0))
        rows = [DhRow(al, a, d, 0.0, j) for (al, a, d), j in zip(shape, joints, strict=True)]
        return cls(modified_dh(name, rows, tool), tool, a1_m=a1, a2_m=a2, a3_m=a3, d4_m=d4)

    def _branches(self, T_base_last: FloatArray, ref: FloatArray) -> tuple[FloatArray, npt.NDArray[np.int8]]:
        q, singular = np.empty((len(T_base_last), 8, 6)), np.zeros(len(T_base_last), np.int8)
        _roots(T_base_last, self.a1_m, self.a2_m, self.a3_m, self.d4_m, ref, q, singular)
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
        return np.array((self.a1_m, self.a2_m, self.a3_m, self.d4_m))

    def _describe(self, T_base_last: FloatArray) -> str:
        p = T_base_last[:3, 3]
        reach = [math.hypot(s * math.hypot(p[0], p[1]) - self.a1_m, p[2]) for s in (1.0, -1.0)]
        fore = math.hypot(self.a3_m, self.d4_m)
        return (
            f"the wrist centre is {min(reach):.3f} m (or {max(reach):.3f} m reaching over) from the shoulder; "
            f"the arm covers {abs(self.a2_m - fore):.3f} to {self.a2_m + fore:.3f} m"
        )
