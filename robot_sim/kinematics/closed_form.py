"""What the closed-form solvers share: every branch checked against forward kinematics, wrapped into limits, judged."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from robot_sim.kinematics.chain import Chain
from robot_sim.kinematics.ik_result import IkBatch, IkResult
from robot_sim.kinematics.kernels import forward_one, residual
from robot_sim.kinematics.transforms import FloatArray, check_poses, inverse_pose

_TWO_PI = 2.0 * math.pi


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
    def _describe(self, T_base_last: FloatArray) -> str:
        """Why the pose of the last link has no root, in one sentence with numbers."""

    def inverse_batch(self, T_base_tool: npt.ArrayLike, q_ref: npt.ArrayLike | None = None) -> IkBatch:
        """All branches of N tool poses (N, 4, 4).

        q_ref (n,) decides between equal turns and fills a joint that a singular pose leaves free; default mid-range.
        Raises RobotError when the input is not N rigid transforms.
        """
        T = check_poses(T_base_tool)
        limits = np.stack([self.chain.lower, self.chain.upper])
        ref = limits.mean(axis=0) if q_ref is None else self.chain.check_q(q_ref)[0]
        T_last = np.ascontiguousarray(T @ inverse_pose(self.T_last_tool))
        q, singular = self._branches(T_last, ref)
        valid, reached = np.zeros(q.shape[:2], np.bool_), np.zeros(q.shape[:2], np.bool_)
        reason, worst = np.zeros(len(q), np.int8), np.zeros((len(q), 2))
        tolerance = np.array([self.tolerance_m, self.tolerance_rad])
        judge(
            self.chain.fixed,
            self.chain.is_prismatic,
            T,
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
        return IkBatch(q, valid, reached, reason, singular, worst[:, 0], worst[:, 1])

    def inverse(self, T_base_tool: npt.ArrayLike, q_ref: npt.ArrayLike | None = None) -> IkResult:
        """All branches of one tool pose (4, 4); see ``inverse_batch``. A pose without solution says why."""
        batch = self.inverse_batch(T_base_tool, q_ref)
        if batch.valid[0].any():
            return batch.result(0)
        if batch.reached[0].any():
            over = [j.name for j, out in zip(self.chain.joints, self._over(batch), strict=True) if out]
            return batch.result(0, f"every branch breaks a joint limit, the nearest one at {', '.join(over)}")
        return batch.result(0, self._describe(check_poses(T_base_tool)[0] @ inverse_pose(self.T_last_tool)))

    def _over(self, batch: IkBatch) -> npt.NDArray[np.bool_]:
        q = batch.q[0][batch.reached[0]]
        over = np.maximum(self.chain.lower - q, q - self.chain.upper)
        return over[int(np.argmin(over.max(axis=1)))] > 1e-9
