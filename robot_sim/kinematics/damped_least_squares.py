"""Numerical inverse kinematics for any chain: damped least squares with joint limits and restarts.

Levenberg-Marquardt on the pose error; damping grows when a step fails and shrinks when it helps (Sugihara 2011's idea
of damping by the error's size). Joints that push into a limit are locked for the step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from robot_sim.errors import RobotError
from robot_sim.kinematics.chain import Chain
from robot_sim.kinematics.ik_result import IkReason, IkResult
from robot_sim.kinematics.kernels import jacobian_one
from robot_sim.kinematics.transforms import check_poses


@dataclass(frozen=True, slots=True)
class DlsSettings:
    """tolerance: weighted error norm that counts as solved, m and rad. restarts: random starts after q_start."""

    tolerance: float = 1e-10
    iterations: int = 100
    restarts: int = 20
    seed: int = 0


@njit(cache=True, nogil=True)
def _error(T: np.ndarray, G: np.ndarray, weight: np.ndarray, e: np.ndarray) -> float:
    """Weighted pose error (6,) into e and its norm; rotation as a rotation vector."""
    wx = wy = wz = 0.0
    trace = 0.0
    for c in range(3):  # rotation vector of G T^-1 from the columns' cross products
        tx, ty, tz = T[0, c], T[1, c], T[2, c]
        gx, gy, gz = G[0, c], G[1, c], G[2, c]
        wx += 0.5 * (ty * gz - tz * gy)
        wy += 0.5 * (tz * gx - tx * gz)
        wz += 0.5 * (tx * gy - ty * gx)
        trace += tx * gx + ty * gy + tz * gz
    s = math.sqrt(wx * wx + wy * wy + wz * wz)
    angle = math.atan2(s, 0.5 * (trace - 1.0))
    scale = angle / s if s > 1e-12 else 1.0
    for r in range(3):
        e[r] = weight[r] * (G[r, 3] - T[r, 3])
    e[3], e[4], e[5] = weight[3] * wx * scale, weight[4] * wy * scale, weight[5] * wz * scale
    return math.sqrt((e * e).sum())


@njit(cache=True, nogil=True)
def _descend(
    fixed: np.ndarray,
    slides: np.ndarray,
    G: np.ndarray,
    q: np.ndarray,
    lower: np.ndarray,
    upper: np.ndarray,
    weight: np.ndarray,
    tolerance: float,
    iterations: int,
) -> float:
    """Improve q (n,) in place; returns the weighted error norm reached."""
    n = len(q)
    J, T = np.empty((6, n)), np.empty((4, 4))
    e, e_try, trial = np.empty(6), np.empty(6), np.empty(n)
    J_try = np.empty((6, n))
    jacobian_one(fixed, slides, q, J, T)
    size = _error(T, G, weight, e)
    damping = 1e-3
    for _ in range(iterations):
        if size < tolerance:
            break
        W = J.copy()
        for r in range(6):
            W[r] *= weight[r]
        g = W.T @ e
        for i in range(n):
            if (q[i] >= upper[i] and g[i] > 0) or (q[i] <= lower[i] and g[i] < 0):
                W[:, i] = 0.0
        H = W.T @ W
        for i in range(n):
            H[i, i] += damping * size * size + 1e-14
        step = np.linalg.solve(H, W.T @ e)
        for i in range(n):
            trial[i] = min(max(q[i] + step[i], lower[i]), upper[i])
        jacobian_one(fixed, slides, trial, J_try, T)
        size_try = _error(T, G, weight, e_try)
        if size_try < size:
            q[:] = trial
            J[:] = J_try
            e[:] = e_try
            size = size_try
            damping = max(damping * 0.2, 1e-9)
        else:
            damping *= 8.0
            if damping * size * size > 1e6:
                break
    return size


def solve_dls(
    chain: Chain,
    T_base_tool: npt.ArrayLike,
    q_start: npt.ArrayLike,
    weight: npt.ArrayLike = (1.0, 1.0, 1.0, 1.0, 1.0, 1.0),
    settings: DlsSettings | None = None,
) -> IkResult:
    """One solution near q_start (n,) of one tool pose (4, 4), inside the joint limits.

    weight (6,) on (x, y, z, rotation x, y, z), base axes; zero frees a direction, as a five-joint arm needs.
    A pose that cannot be reached comes back as ``ik.not_converged`` with the error of the best try.
    """
    s = settings or DlsSettings()
    G = check_poses(T_base_tool)[0]
    w = np.asarray(weight, dtype=np.float64)
    if w.shape != (6,) or (w < 0).any() or not w.any():
        raise RobotError(f"weight needs six values, none negative and not all zero, got {w}")
    lower, upper = chain.lower, chain.upper
    start = chain.check_q(q_start)[0]
    # restarts need a finite box even for joints that turn without end
    low, high = np.maximum(lower, -np.pi), np.minimum(upper, np.pi)
    rng = np.random.default_rng(s.seed)
    best, best_size = np.clip(start, lower, upper), math.inf
    for attempt in range(s.restarts + 1):
        q = np.clip(start, lower, upper) if attempt == 0 else rng.uniform(low, high)
        size = _descend(chain.fixed, chain.is_prismatic, G, q, lower, upper, w, s.tolerance, s.iterations)
        if size < best_size:
            best, best_size = q, size
        if best_size < s.tolerance:
            break
    T, e = chain.forward(best), np.empty(6)
    _error(T, G, np.ones(6), e)
    e_m, e_rad = float(np.linalg.norm(e[:3])), float(np.linalg.norm(e[3:]))
    singular = np.linalg.svd(w[:, None] * chain.jacobian(best), compute_uv=False)
    flat = ("jacobian",) if singular[min(chain.n, int((w > 0).sum())) - 1] < 1e-6 * singular[0] else ()
    solved = best_size < s.tolerance
    reason = (IkReason.SINGULAR if flat else IkReason.SOLVED) if solved else IkReason.NOT_CONVERGED
    detail = (
        ""
        if solved
        else f"best of {s.restarts + 1} starts is off by {e_m * 1e3:.3f} mm and {math.degrees(e_rad):.3f} deg"
    )
    q_out = best[None] if solved else np.empty((0, chain.n))
    return IkResult(q_out, reason, flat, np.empty((0, chain.n)), e_m, e_rad, detail)
