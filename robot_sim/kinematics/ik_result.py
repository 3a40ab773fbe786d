"""What inverse kinematics returns: solutions and a reason, never an exception for a pose that cannot be had."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from robot_sim.kinematics.transforms import FloatArray


class IkReason(StrEnum):
    """Why an inverse has, or has not, a solution."""

    SOLVED = "ik.solved"
    SINGULAR = "ik.singular"
    UNREACHABLE = "ik.unreachable"
    ORIENTATION = "ik.orientation"
    JOINT_LIMIT = "ik.joint_limit"
    NOT_CONVERGED = "ik.not_converged"


REASONS: tuple[IkReason, ...] = tuple(IkReason)
"""Kernels give a reason as its index here."""

SINGULAR_SHOULDER, SINGULAR_ELBOW, SINGULAR_WRIST = 1, 2, 4
"""Bits of the singularity flag."""


def singular_names(bits: int) -> tuple[str, ...]:
    """The singularity flag in words."""
    named = ((SINGULAR_SHOULDER, "shoulder"), (SINGULAR_ELBOW, "elbow"), (SINGULAR_WRIST, "wrist"))
    return tuple(word for bit, word in named if bits & bit)


SINGULAR_WORDS: tuple[tuple[str, ...], ...] = tuple(singular_names(bits) for bits in range(8))
"""The same for every value of the flag."""


@dataclass(frozen=True, slots=True, eq=False)
class IkResult:
    """All solutions of one pose.

    q: (K, n) solutions inside the joint limits, K may be 0. singular: which of shoulder, elbow, wrist are singular
    (a singular pose has solutions, but one joint of them was chosen freely). beyond_limits: (M, n) solutions that
    reach the pose but break a joint limit. residual_m, residual_rad: worst forward-kinematics residual over q.
    """

    q: FloatArray
    reason: IkReason
    singular: tuple[str, ...]
    beyond_limits: FloatArray
    residual_m: float
    residual_rad: float
    detail: str

    @property
    def ok(self) -> bool:
        """Whether there is at least one solution inside the limits."""
        return len(self.q) > 0

    def nearest(self, q_ref: npt.ArrayLike) -> FloatArray | None:
        """The solution (n,) with the least largest joint motion from q_ref, or None."""
        if not self.ok:
            return None
        motion = np.abs(self.q - np.asarray(q_ref, dtype=np.float64)).max(axis=1)
        return self.q[int(np.argmin(motion))]


@dataclass(frozen=True, slots=True, eq=False)
class IkBatch:
    """Solutions of N poses: q (N, B, n) with valid (N, B) marking branches, reason (N,) and singular (N,) as codes.

    reason indexes REASONS; singular holds the SINGULAR_* bits; reached (N, B) marks branches that reach the pose
    whether or not they keep the joint limits.
    """

    q: FloatArray
    valid: npt.NDArray[np.bool_]
    reached: npt.NDArray[np.bool_]
    reason: npt.NDArray[np.int8]
    singular: npt.NDArray[np.int8]
    residual_m: FloatArray
    residual_rad: FloatArray

    def result(self, k: int, detail: str = "") -> IkResult:
        """The k-th pose's answer on its own."""
        return IkResult(
            self.q[k][self.valid[k]],
            REASONS[int(self.reason[k])],
            singular_names(int(self.singular[k])),
            self.q[k][self.reached[k] & ~self.valid[k]],
            float(self.residual_m[k]),
            float(self.residual_rad[k]),
            detail,
        )
