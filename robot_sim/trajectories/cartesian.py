"""Straight lines of the tool with a drive transform (Paul; the plantlet source's (8)-(13)), brought to joint space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robot_sim.errors import RobotError
from robot_sim.kinematics.closed_form import ClosedFormArm
from robot_sim.kinematics.ik_result import IkReason
from robot_sim.kinematics.transforms import FloatArray, check_poses, inverse_pose, pose_error
from robot_sim.trajectories.trajectory import Motion


@dataclass(frozen=True, eq=False)
class DriveLine:
    """T_base_tool(l) = T_base_start D(l): D moves by l * shift (3,) m and turns by l * turn (3,) rad, start's axes.

    With T_base_start = T_B B_P1 and turn zero this is the source's (8) and (13); l runs from 0 to 1.
    """

    T_base_start: FloatArray
    shift_m: FloatArray
    turn_rad: FloatArray

    @classmethod
    def between(cls, T_base_start: npt.ArrayLike, T_base_end: npt.ArrayLike) -> DriveLine:
        """The drive that ends at T_base_end: D(1) = T_start^-1 T_end (9)."""
        start, end = check_poses(T_base_start)[0], check_poses(T_base_end)[0]
        error = pose_error(np.eye(4), inverse_pose(start) @ end)
        return cls(start, error[:3], error[3:])

    def pose(self, share: npt.ArrayLike) -> FloatArray:
        """Tool poses (M, 4, 4) at shares l (M,)."""
        s = np.atleast_1d(np.asarray(share, dtype=np.float64))
        D = np.broadcast_to(np.eye(4), (len(s), 4, 4)).copy()
        angle = float(np.linalg.norm(self.turn_rad))
        if angle > 0:
            x, y, z = self.turn_rad / angle
            K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            a = (s * angle)[:, None, None]
            D[:, :3, :3] += np.sin(a) * K + (1 - np.cos(a)) * (K @ K)
        D[:, :3, 3] = s[:, None] * self.shift_m
        return self.T_base_start @ D


@dataclass(frozen=True, slots=True, eq=False)
class LineResult:
    """motion is None when some point of the line has no solution; then reason, share (0..1) and detail say which."""

    motion: Motion | None
    reason: IkReason
    share: float
    detail: str
    worst_step_rad: float


def follow_line(
    arm: ClosedFormArm,
    line: DriveLine,
    duration_s: float,
    step_s: float,
    q_start: npt.ArrayLike,
    smooth: bool = False,
) -> LineResult:
    """Inverse kinematics along the line at the trajectory rate, always on the branch nearest to the last sample.

    smooth False is the source's constant speed; True starts and ends at rest (quintic share). Speeds and accelerations
    are finite differences of the samples. A jump of more than 0.5 rad between samples is refused as a branch change.
    """
    if not (duration_s > 0 and step_s > 0):
        raise RobotError(f"duration and step must be positive, got {duration_s} s and {step_s} s")
    count = max(2, round(duration_s / step_s) + 1)
    t = np.linspace(0.0, duration_s, count)
    tau = t / duration_s
    share = tau**3 * (10 - 15 * tau + 6 * tau**2) if smooth else tau
    poses = line.pose(share)
    q = np.empty((count, arm.chain.n))
    last = np.asarray(q_start, dtype=np.float64)
    worst = 0.0
    for k in range(count):
        result = arm.inverse(poses[k], q_ref=last)
        nearest = result.nearest(last)
        if nearest is None:
            return LineResult(None, result.reason, float(share[k]), result.detail, worst)
        if k:
            worst = max(worst, float(np.abs(nearest - last).max()))
            if worst > 0.5:
                detail = f"the nearest branch jumps by {np.degrees(worst):.0f} deg"
                return LineResult(None, IkReason.SINGULAR, float(share[k]), detail, worst)
        q[k] = last = nearest
    qd = np.asarray(np.gradient(q, t, axis=0))
    return LineResult(Motion(t, q, qd, np.asarray(np.gradient(qd, t, axis=0))), IkReason.SOLVED, 1.0, "", worst)
