"""Where the links of the three arms are for given joint angles: forward kinematics in the disc's axes, compiled."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from robot_sim.capsules import arm_model
from robot_sim.config import RobotConfig

F64 = npt.NDArray[np.float64]
_T, _M, _V = "float64[:,:,:,::1]", "float64[:,:,::1]", "float64[::1]"


@njit(f"void({_T}, {_M}, {_V}, {_M}, float64[:,::1])", cache=True, nogil=True)
def forward(T_joint, axis, q, R, p):  # type: ignore[no-untyped-def]
    """Poses of the nine moving links: R (9, 3, 3), p (9, 3), from joint angles q (9,) [rad]."""
    for arm in range(3):
        for j in range(3):
            k = 3 * arm + j
            x, y, z = axis[arm, j, 0], axis[arm, j, 1], axis[arm, j, 2]
            c, s = np.cos(q[k]), np.sin(q[k])
            v = 1.0 - c
            turn = np.array(
                [
                    [c + x * x * v, x * y * v - z * s, x * z * v + y * s],
                    [y * x * v + z * s, c + y * y * v, y * z * v - x * s],
                    [z * x * v - y * s, z * y * v + x * s, c + z * z * v],
                ]
            )
            local = np.zeros((3, 3))
            for a in range(3):
                for b in range(3):
                    for m in range(3):
                        local[a, b] += T_joint[arm, j, a, m] * turn[m, b]
            for a in range(3):
                if j == 0:
                    p[k, a] = T_joint[arm, j, a, 3]
                    for b in range(3):
                        R[k, a, b] = local[a, b]
                else:
                    p[k, a] = p[k - 1, a]
                    for m in range(3):
                        p[k, a] += R[k - 1, a, m] * T_joint[arm, j, m, 3]
                    for b in range(3):
                        total = 0.0
                        for m in range(3):
                            total += R[k - 1, a, m] * local[m, b]
                        R[k, a, b] = total


@njit(f"void({_T}, {_M}, float64[:,::1], {_T}, {_M})", cache=True, nogil=True)
def _forward_many(T_joint, axis, q, R, p):  # type: ignore[no-untyped-def]
    """The same for postures q (N, 9): R (N, 9, 3, 3), p (N, 9, 3)."""
    for k in range(len(q)):
        forward(T_joint, axis, q[k], R[k], p[k])


def link_poses(q_rad: npt.ArrayLike, config: RobotConfig) -> tuple[F64, F64]:
    """Rotations (9, 3, 3) and origins (9, 3) [m] of the arms' moving links, in the disc's axes.

    q_rad: (9,) C1, C2, elbow of the right, left and rear arm [rad]; (N, 9) gives (N, 9, 3, 3) and (N, 9, 3).
    """
    m = arm_model(config)
    q = np.ascontiguousarray(q_rad, np.float64)
    qs = q.reshape(-1, 9)
    R, p = np.zeros((len(qs), 9, 3, 3)), np.zeros((len(qs), 9, 3))
    _forward_many(m.T_joint, m.axis, qs, R, p)
    return (R[0], p[0]) if q.ndim == 1 else (R, p)
