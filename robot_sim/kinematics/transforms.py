"""Rigid transforms as 4x4 float64 matrices, metres and radians: ``T_a_b`` takes points of frame b to frame a."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from robot_sim.errors import RobotError

FloatArray = npt.NDArray[np.float64]


def rot_x(angle_rad: float) -> FloatArray:
    """Rotation about x as a 4x4 transform."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[1.0, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]])


def rot_y(angle_rad: float) -> FloatArray:
    """Rotation about y as a 4x4 transform."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[c, 0, s, 0], [0, 1.0, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1]])


def rot_z(angle_rad: float) -> FloatArray:
    """Rotation about z as a 4x4 transform."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1.0, 0], [0, 0, 0, 1]])


def translation(x_m: float, y_m: float, z_m: float) -> FloatArray:
    """Pure translation as a 4x4 transform."""
    T = np.eye(4)
    T[:3, 3] = (x_m, y_m, z_m)
    return T


def rpy(roll_rad: float, pitch_rad: float, yaw_rad: float) -> FloatArray:
    """Fixed-axis roll, pitch, yaw (URDF's order: Rz(yaw) Ry(pitch) Rx(roll)) as a 4x4 transform."""
    return rot_z(yaw_rad) @ rot_y(pitch_rad) @ rot_x(roll_rad)


def to_rpy(T: FloatArray) -> tuple[float, float, float]:
    """Roll, pitch, yaw in rad of a transform; at pitch = +-90 deg the roll is set to zero."""
    cy = math.hypot(T[0, 0], T[1, 0])
    if cy < 1e-12:
        return 0.0, math.atan2(-T[2, 0], cy), math.atan2(-T[0, 1], T[1, 1])
    return math.atan2(T[2, 1], T[2, 2]), math.atan2(-T[2, 0], cy), math.atan2(T[1, 0], T[0, 0])


def to_quaternion(T: FloatArray) -> tuple[float, float, float, float]:
    """Unit quaternion (x, y, z, w) of a transform's rotation, w >= 0 (Shepperd's method)."""
    R = T[:3, :3]
    w2 = np.array([R[0, 0], R[1, 1], R[2, 2], np.trace(R)])
    k = int(np.argmax(w2))
    if k == 3:
        q = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], 1.0 + w2[3]])
    else:
        i, j, m = k, (k + 1) % 3, (k + 2) % 3
        q = np.empty(4)
        q[i] = 1.0 + R[i, i] - R[j, j] - R[m, m]
        q[j] = R[i, j] + R[j, i]
        q[m] = R[i, m] + R[m, i]
        q[3] = R[m, j] - R[j, m]
    q /= np.linalg.norm(q) * (1.0 if q[3] >= 0 else -1.0)
    return float(q[0]), float(q[1]), float(q[2]), float(q[3])


def rotation_between(a: npt.ArrayLike, b: npt.ArrayLike) -> FloatArray:
    """The shortest rotation, as a 4x4 transform, that turns direction a (3,) into direction b (3,)."""
    u = np.asarray(a, dtype=np.float64) / np.linalg.norm(a)
    v = np.asarray(b, dtype=np.float64) / np.linalg.norm(b)
    T = np.eye(4)
    c = float(u @ v)
    if c < -1.0 + 1e-12:
        axis = np.cross(u, np.eye(3)[int(np.argmin(np.abs(u)))])
        axis /= np.linalg.norm(axis)
        T[:3, :3] = 2.0 * np.outer(axis, axis) - np.eye(3)
        return T
    w = np.cross(u, v)
    K = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
    T[:3, :3] = np.eye(3) + K + K @ K / (1.0 + c)
    return T


def inverse_pose(T: FloatArray) -> FloatArray:
    """Inverse of a rigid transform (..., 4, 4) without a matrix inversion."""
    out = np.zeros_like(T)
    R_t = np.swapaxes(T[..., :3, :3], -1, -2)
    out[..., :3, :3] = R_t
    out[..., :3, 3] = -np.einsum("...ij,...j->...i", R_t, T[..., :3, 3])
    out[..., 3, 3] = 1.0
    return out


def pose_error(T: FloatArray, T_goal: FloatArray) -> FloatArray:
    """What moves T to T_goal, in base axes: (6,) of translation in m, then rotation vector in rad."""
    R = T_goal[:3, :3] @ T[:3, :3].T
    w = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    s, c = float(np.linalg.norm(w)), 0.5 * (float(np.trace(R)) - 1.0)
    angle = math.atan2(s, c)
    if s > 1e-9:
        w = w * (angle / s)
    elif c < 0.0:  # half a turn: the axis comes from R + I
        k = int(np.argmax(np.diag(R)))
        axis = (R + np.eye(3))[:, k]
        w = axis / np.linalg.norm(axis) * angle
    return np.concatenate([T_goal[:3, 3] - T[:3, 3], w])


def check_poses(T: npt.ArrayLike) -> FloatArray:
    """The argument as (N, 4, 4) float64 rigid transforms. Raises RobotError for anything else."""
    out = np.ascontiguousarray(T, dtype=np.float64)
    if out.ndim == 2:
        out = out[None]
    if out.ndim != 3 or out.shape[1:] != (4, 4):
        raise RobotError(f"a pose is a 4x4 matrix, or (N, 4, 4) for many, got shape {np.shape(T)}")
    if not np.isfinite(out).all():
        raise RobotError("a pose holds values that are not finite; give a rigid transform in metres")
    R = out[:, :3, :3]
    skew = np.abs(np.swapaxes(R, 1, 2) @ R - np.eye(3)).max(initial=0.0)
    if skew > 1e-6 or (len(out) and np.linalg.det(R).min() < 0):
        raise RobotError(
            f"a pose is not a rigid transform (R^T R is off the identity by {skew:.1e}, or mirrored); "
            "its left upper 3x3 block must be a rotation"
        )
    return out
