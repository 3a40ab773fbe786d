"""What the closed-form solvers share: every branch checked against forward kinematics, wrapped into limits, judged."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from numba import njit

from robot_sim.kinematics.chain import Chain
from robot_sim.kinematics.ik_result import REASONS, SINGULAR_WORDS, IkBatch, IkResult
from robot_sim.kinematics.kernels import forward_one, residual
from robot_sim.kinematics.transforms import FloatArray, check_poses, inverse_pose

_TWO_PI = 2.0 * math.pi

OneAnswer = tuple[FloatArray, FloatArray, int, int, float, float]
"""Solutions (K, n) inside the limits, those beyond (M, n), reason, singularity bits, residuals in m and rad."""


@njit(cache=True, nogil=True)
def into_limits(q: float, ref: float, lower: float, upper: float) -> float:
    """q shifted by whole turns to lie in [lower, upper] as near to ref as can be; NaN when no shift fits."""
    q += _TWO_PI * round((ref - q) / _TWO_PI)
    if q > upper + 1e-9:
        q -= _TWO_PI * math.ceil((q - upper - 1e-9) / _TWO_PI)
    elif q < lower - 1e-9:
        q += _TWO_PI * math.ceil((lower - 1e-9 - q) / _TWO_PI)
    return q if lower - 1e-9 <= q <= upper + 1e-9 else math.nan


@njit(cache=True, nogil=True)
def _same(a: np.ndarray, b: np.ndarray) -> bool:
    for i in range(len(a)):
        d = a[i] - b[i]
        if abs(d - _TWO_PI * round(d / _TWO_PI)) > 1e-9:
            return False
    return True


@njit(cache=True, nogil=True)
def judge(
    fixed: np.ndarray,
    slides: np.ndarray,
    T_goal: np.ndarray,
    ref: np.ndarray,
    limits: np.ndarray,
    tolerance: np.ndarray,
    q: np.ndarray,
    valid: np.ndarray,
    reached: np.ndarray,
    reason: np.ndarray,
    singular: np.ndarray,
    worst: np.ndarray,
) -> None:
    """Sort the branches q (N, B, n) of T_goal (N, 4, 4) into reached and valid; NaN marks a branch without a root.

    limits: (2, n). tolerance, worst: metres and radians. reason: index into ik_result.REASONS.
    """
    T = np.empty((4, 4))
    wrapped = np.empty(q.shape[2])
    for k in range(q.shape[0]):
        rooted, any_reached, any_valid = False, False, False
        for b in range(q.shape[1]):
            if math.isnan(q[k, b, 0]):
                continue
            rooted = True
            forward_one(fixed, slides, q[k, b], T)
            e_m, e_rad = residual(T, T_goal[k])
            if not (e_m <= tolerance[0] and e_rad <= tolerance[1]):
                continue
            twin = False
            for other in range(b):
                twin = twin or (reached[k, other] and _same(q[k, b], q[k, other]))
            if twin:
                continue
            reached[k, b] = any_reached = True
            inside = True
            for i in range(q.shape[2]):
                wrapped[i] = into_limits(q[k, b, i], ref[i], limits[0, i], limits[1, i])
                inside = inside and not math.isnan(wrapped[i])
            if inside:
                q[k, b] = wrapped
                valid[k, b] = any_valid = True
                worst[k, 0] = max(worst[k, 0], e_m)
                worst[k, 1] = max(worst[k, 1], e_rad)
        if any_valid:
            reason[k] = 1 if singular[k] else 0
        else:
            reason[k] = 4 if any_reached else (3 if rooted else 2)


@njit(cache=True, nogil=True)
def last_link(T_base_tool: np.ndarray, T_tool_last: np.ndarray, T: np.ndarray) -> bool:
    """Pose of the last link into T (1, 4, 4); False when the tool's pose (4, 4) is no rigid transform."""
    for i in range(3):
        for j in range(3):
            dot = 0.0
            for r in range(3):
                dot += T_base_tool[r, i] * T_base_tool[r, j]
            if not abs(dot - (1.0 if i == j else 0.0)) <= 1e-6:  # not a number is refused too
                return False
    a, b, c = T_base_tool[0], T_base_tool[1], T_base_tool[2]
    det = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    if det < 0.0:
        return False
    for r in range(4):
        for k in range(4):
            T[0, r, k] = 0.0
            for m in range(4):
                T[0, r, k] += T_base_tool[r, m] * T_tool_last[m, k]
            if not math.isfinite(T[0, r, k]):
                return False
    return True


@njit(cache=True, nogil=True)
def answer(
    fixed: np.ndarray,
    slides: np.ndarray,
    T_base_tool: np.ndarray,
    ref: np.ndarray,
    limits: np.ndarray,
    tolerance: np.ndarray,
    q: np.ndarray,
    singular: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, int, int, float, float]:
    """Judge the branches q (1, B, n) of one pose (4, 4) and part them; see OneAnswer."""
    count, n = q.shape[1], q.shape[2]
    valid, reached = np.zeros((1, count), np.bool_), np.zeros((1, count), np.bool_)
    reason, worst = np.zeros(1, np.int8), np.zeros((1, 2))
    judge(
        fixed,
        slides,
        T_base_tool.reshape((1, 4, 4)),
        ref,
        limits,
        tolerance,
        q,
        valid,
        reached,
        reason,
        singular,
        worst,
    )
    inside, beyond = np.empty((count, n)), np.empty((count, n))
    i, j = 0, 0
    for b in range(count):
        if valid[0, b]:
            inside[i] = q[0, b]
            i += 1
        elif reached[0, b]:
            beyond[j] = q[0, b]
            j += 1
    return inside[:i], beyond[:j], int(reason[0]), int(singular[0]), worst[0, 0], worst[0, 1]


@dataclass(frozen=True, eq=False)
class ClosedFormArm(ABC):
    """An arm whose inverse is a formula. tolerance_m, tolerance_rad: residual above which a branch is refused."""

    chain: Chain
    T_last_tool: FloatArray
    tolerance_m: float = 1e-6
    tolerance_rad: float = 1e-6

    @abstractmethod
    def _branches(self, T_base_last: FloatArray, ref: FloatArray) -> tuple[FloatArray, npt.NDArray[np.int8]]:
        """Raw roots (N, B, n), NaN where there is none, and singularity bits (N,), for poses of the last link."""

    @abstractmethod
    def _solve(self, T_base_tool: FloatArray, ref: FloatArray) -> OneAnswer | None:
        """The answer for one tool pose (4, 4) in one compiled call; None when it is no rigid transform."""

    @abstractmethod
    def _describe(self, T_base_last: FloatArray) -> str:
        """Why the pose of the last link has no root, in one sentence with numbers."""

    def inverse_batch(self, T_base_tool: npt.ArrayLike, q_ref: npt.ArrayLike | None = None) -> IkBatch:
        """All branches of N tool poses (N, 4, 4).

        q_ref (n,) decides between equal turns and fills a joint that a singular pose leaves free; default mid-range.
        Raises RobotError when the input is not N rigid transforms.
        """
        T = check_poses(T_base_tool)
        limits = self._limits
        ref = self._middle if q_ref is None else self.chain.check_q(q_ref)[0]
        T_last = np.ascontiguousarray(T @ self._T_tool_last)
        q, singular = self._branches(T_last, ref)
        valid, reached = np.zeros(q.shape[:2], np.bool_), np.zeros(q.shape[:2], np.bool_)
        reason, worst = np.zeros(len(q), np.int8), np.zeros((len(q), 2))
        judge(
            self.chain.fixed,
            self._slides,
            T,
            ref,
            limits,
            self._tolerance,
            q,
            valid,
            reached,
            reason,
            singular,
            worst,
        )
        return IkBatch(q, valid, reached, reason, singular, worst[:, 0], worst[:, 1])

    def inverse(self, T_base_tool: npt.ArrayLike, q_ref: npt.ArrayLike | None = None) -> IkResult:
        """All branches of one tool pose (4, 4); see ``inverse_batch``. A pose without solution says why."""
        T = np.ascontiguousarray(T_base_tool, dtype=np.float64)
        if T.shape != (4, 4):
            T = check_poses(T)[0]
        ref = self._middle if q_ref is None else self.chain.check_q(q_ref)[0]
        found = self._solve(T, ref)
        if found is None:
            check_poses(T)  # says what is wrong
            raise AssertionError("a pose the compiled check refuses is refused here too")
        q, beyond, reason, singular, e_m, e_rad = found
        detail = "" if len(q) else self._why_not(T, beyond)
        return IkResult(q, REASONS[reason], SINGULAR_WORDS[singular], beyond, e_m, e_rad, detail)

    def _why_not(self, T_base_tool: FloatArray, beyond: FloatArray) -> str:
        if len(beyond) == 0:
            return self._describe(T_base_tool @ self._T_tool_last)
        over = np.maximum(self.chain.lower - beyond, beyond - self.chain.upper)
        worst = over[int(np.argmin(over.max(axis=1)))] > 1e-9
        names = [j.name for j, out in zip(self.chain.joints, worst, strict=True) if out]
        return f"every branch breaks a joint limit, the nearest one at {', '.join(names)}"

    @cached_property
    def _limits(self) -> FloatArray:
        return np.stack([self.chain.lower, self.chain.upper])

    @cached_property
    def _middle(self) -> FloatArray:
        return np.ascontiguousarray(self._limits.mean(axis=0))

    @cached_property
    def _slides(self) -> npt.NDArray[np.bool_]:
        return self.chain.is_prismatic

    @cached_property
    def _tolerance(self) -> FloatArray:
        return np.array([self.tolerance_m, self.tolerance_rad])

    @cached_property
    def _T_tool_last(self) -> FloatArray:
        return np.ascontiguousarray(inverse_pose(self.T_last_tool))
