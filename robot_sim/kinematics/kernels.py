"""The loops over joints, compiled: forward kinematics, frames, Jacobian."""

from __future__ import annotations

import math

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, inline="always")
def _move(T: np.ndarray, slides: bool, q: float) -> None:
    """T <- T J(q), J about or along z."""
    if slides:
        for r in range(3):
            T[r, 3] += T[r, 2] * q
        return
    c, s = math.cos(q), math.sin(q)
    for r in range(3):
        x, y = T[r, 0], T[r, 1]
        T[r, 0] = c * x + s * y
        T[r, 1] = c * y - s * x


@njit(cache=True, nogil=True, inline="always")
def _append(T: np.ndarray, F: np.ndarray) -> None:
    """T <- T F for rigid transforms."""
    for r in range(3):
        x, y, z, p = T[r, 0], T[r, 1], T[r, 2], T[r, 3]
        for c in range(4):
            T[r, c] = x * F[0, c] + y * F[1, c] + z * F[2, c]
        T[r, 3] += p


@njit(cache=True, nogil=True)
def forward_one(fixed: np.ndarray, slides: np.ndarray, q: np.ndarray, T: np.ndarray) -> None:
    """Tool pose of one configuration q (n,) into T (4, 4)."""
    T[:] = fixed[0]
    for i in range(len(q)):
        _move(T, slides[i], q[i])
        _append(T, fixed[i + 1])


@njit(cache=True, nogil=True)
def forward(fixed: np.ndarray, slides: np.ndarray, q: np.ndarray, T: np.ndarray) -> None:
    """Tool poses of q (N, n) into T (N, 4, 4)."""
    for k in range(len(q)):
        forward_one(fixed, slides, q[k], T[k])


@njit(cache=True, nogil=True)
def frames(fixed: np.ndarray, slides: np.ndarray, q: np.ndarray, T: np.ndarray) -> None:
    """Moving frames and tool of one q (n,) into T (n+1, 4, 4)."""
    n = len(q)
    current = fixed[0].copy()
    for i in range(n):
        _move(current, slides[i], q[i])
        T[i] = current
        _append(current, fixed[i + 1])
    T[n] = current


@njit(cache=True, nogil=True)
def jacobian_one(fixed: np.ndarray, slides: np.ndarray, q: np.ndarray, J: np.ndarray, T: np.ndarray) -> None:
    """Base-frame geometric Jacobian into J (6, n) and tool pose into T (4, 4)."""
    n = len(q)
    T[:] = fixed[0]
    for i in range(n):
        _move(T, slides[i], q[i])
        for r in range(3):
            J[r, i] = T[r, 3]  # joint origin, until the tool's is known
            J[3 + r, i] = T[r, 2]
        _append(T, fixed[i + 1])
    for i in range(n):
        zx, zy, zz = J[3, i], J[4, i], J[5, i]
        if slides[i]:
            J[0, i], J[1, i], J[2, i] = zx, zy, zz
            J[3, i], J[4, i], J[5, i] = 0.0, 0.0, 0.0
        else:
            x, y, z = T[0, 3] - J[0, i], T[1, 3] - J[1, i], T[2, 3] - J[2, i]
            J[0, i] = zy * z - zz * y
            J[1, i] = zz * x - zx * z
            J[2, i] = zx * y - zy * x


@njit(cache=True, nogil=True)
def jacobian(fixed: np.ndarray, slides: np.ndarray, q: np.ndarray, J: np.ndarray) -> None:
    """Base-frame geometric Jacobians of q (N, n) into J (N, 6, n)."""
    T = np.empty((4, 4))
    for k in range(len(q)):
        jacobian_one(fixed, slides, q[k], J[k], T)


@njit(cache=True, nogil=True)
def residual(T: np.ndarray, T_goal: np.ndarray) -> tuple[float, float]:
    """Distance in m and angle in rad between two poses; the angle is exact for small and right for large ones."""
    d2 = 0.0
    for r in range(3):
        d2 += (T[r, 3] - T_goal[r, 3]) ** 2
    f2 = 0.0
    for r in range(3):
        for c in range(3):
            f2 += (T[r, c] - T_goal[r, c]) ** 2
    # |R - R'|_F = 2 sqrt(2) sin(angle / 2)
    return math.sqrt(d2), 2.0 * math.asin(min(1.0, math.sqrt(f2 / 8.0)))
