"""The head camera as matrices: from the pose of its optical centre to what a renderer wants. Pure."""

from __future__ import annotations

from math import tan

import numpy as np
import numpy.typing as npt

F64 = npt.NDArray[np.float64]
NEAR_M = 0.06
FAR_M = 12.0


def view_matrix(xyz_m: npt.ArrayLike, R_world_camera: npt.ArrayLike) -> F64:
    """(4, 4) OpenGL view matrix of a camera that looks along its x axis with z up (URDF link ``head_camera``)."""
    R = np.asarray(R_world_camera, dtype=np.float64)
    # OpenGL looks along -z with x right and y up
    right, up, back = -R[:, 1], R[:, 2], -R[:, 0]
    T = np.eye(4)
    T[:3, :3] = np.stack([right, up, back])
    T[:3, 3] = -T[:3, :3] @ np.asarray(xyz_m, dtype=np.float64)
    return T


def projection_matrix(fov_rad: float, width: int, height: int) -> F64:
    """(4, 4) OpenGL projection matrix; ``fov_rad`` is the vertical field of view."""
    f = 1.0 / tan(0.5 * fov_rad)
    P = np.zeros((4, 4))
    P[0, 0], P[1, 1] = f * height / width, f
    P[2, 2] = (FAR_M + NEAR_M) / (NEAR_M - FAR_M)
    P[2, 3] = 2.0 * FAR_M * NEAR_M / (NEAR_M - FAR_M)
    P[3, 2] = -1.0
    return P
