"""A serial chain and its forward kinematics and Jacobians, for one pose or many."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from robot_sim.errors import RobotError
from robot_sim.kinematics import kernels
from robot_sim.kinematics.transforms import FloatArray

JointKind = Literal["revolute", "prismatic"]


@dataclass(frozen=True, slots=True)
class Joint:
    """One joint. Limits and speed in rad and rad/s (m and m/s when prismatic)."""

    name: str
    kind: JointKind = "revolute"
    lower: float = -np.pi
    upper: float = np.pi
    speed: float = np.inf

    def __post_init__(self) -> None:
        if not self.lower <= self.upper:
            raise RobotError(f"joint {self.name}: lower limit {self.lower} lies above the upper one {self.upper}")


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """A serial arm as ``F0 J1(q1) F1 J2(q2) ... Jn(qn) Fn``: J turns about or slides along its own z.

    fixed: (n+1, 4, 4), metres; fixed[n] is what follows the last joint, the tool included.
    """

    name: str
    joints: tuple[Joint, ...]
    fixed: FloatArray

    def __post_init__(self) -> None:
        if self.fixed.shape != (len(self.joints) + 1, 4, 4):
            raise RobotError(f"{self.name}: {len(self.joints)} joints need {len(self.joints) + 1} fixed transforms")

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joints)

    @property
    def lower(self) -> FloatArray:
        """Lower joint limits (n,)."""
        return np.array([j.lower for j in self.joints])

    @property
    def upper(self) -> FloatArray:
        """Upper joint limits (n,)."""
        return np.array([j.upper for j in self.joints])

    @property
    def speed(self) -> FloatArray:
        """Speed limits (n,); inf where none is known."""
        return np.array([j.speed for j in self.joints])

    @property
    def is_prismatic(self) -> npt.NDArray[np.bool_]:
        """(n,) True where a joint slides."""
        return np.array([j.kind == "prismatic" for j in self.joints])

    def with_tool(self, T_last_tool: FloatArray) -> Chain:
        """The same arm with one more fixed transform behind its present end."""
        fixed = self.fixed.copy()
        fixed[-1] = fixed[-1] @ T_last_tool
        return replace(self, fixed=fixed)

    def check_q(self, q: npt.ArrayLike) -> FloatArray:
        """The argument as (N, n) float64. Raises RobotError when the shape is wrong or a value is not finite."""
        out = np.ascontiguousarray(q, dtype=np.float64)
        out = out[None] if out.ndim == 1 else out
        if out.ndim != 2 or out.shape[1] != self.n:
            raise RobotError(
                f"{self.name} has {self.n} joints; q must be ({self.n},) or (N, {self.n}), not {np.shape(q)}"
            )
        if not np.isfinite(out).all():
            raise RobotError(f"{self.name}: joint values must be finite")
        return out

    def forward(self, q: npt.ArrayLike) -> FloatArray:
        """Pose of the tool, (4, 4) for q (n,), (N, 4, 4) for q (N, n)."""
        qs = self.check_q(q)
        T = np.empty((len(qs), 4, 4))
        kernels.forward(self.fixed, self.is_prismatic, qs, T)
        return T[0] if np.ndim(q) == 1 else T

    def frames(self, q: npt.ArrayLike) -> FloatArray:
        """Poses of all moving frames and the tool for one q (n,): (n+1, 4, 4); frame i moves with joint i."""
        qs = self.check_q(q)
        T = np.empty((self.n + 1, 4, 4))
        kernels.frames(self.fixed, self.is_prismatic, qs[0], T)
        return T

    def jacobian(self, q: npt.ArrayLike) -> FloatArray:
        """Geometric Jacobian in base axes, tool velocity (v, omega) = J qd: (6, n), or (N, 6, n) for many."""
        qs = self.check_q(q)
        J = np.empty((len(qs), 6, self.n))
        kernels.jacobian(self.fixed, self.is_prismatic, qs, J)
        return J[0] if np.ndim(q) == 1 else J

    def jacobian_tool(self, q: npt.ArrayLike) -> FloatArray:
        """Geometric Jacobian in the tool's own axes; shapes as ``jacobian``."""
        J = np.atleast_3d(self.jacobian(q)) if np.ndim(q) > 1 else self.jacobian(q)[None]
        R_t = np.swapaxes(self.forward(self.check_q(q))[:, :3, :3], 1, 2)
        out = np.concatenate([R_t @ J[:, :3], R_t @ J[:, 3:]], axis=1)
        return out[0] if np.ndim(q) == 1 else out

    def manipulability(self, q: npt.ArrayLike) -> float:
        """Yoshikawa's measure, the product of the Jacobian's singular values; 0 at a singular pose."""
        return float(np.prod(np.linalg.svd(self.jacobian(q), compute_uv=False)))

    def within_limits(self, q: npt.ArrayLike, tolerance: float = 1e-9) -> bool:
        """Whether all joints of q (n,) or (N, n) lie inside their limits."""
        qs = self.check_q(q)
        return bool(((qs >= self.lower - tolerance) & (qs <= self.upper + tolerance)).all())
