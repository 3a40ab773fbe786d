"""Denavit-Hartenberg tables, standard and modified (Craig), to chains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from robot_sim.errors import RobotError
from robot_sim.kinematics.chain import Chain, Joint
from robot_sim.kinematics.transforms import FloatArray, rot_x, rot_z, translation


@dataclass(frozen=True, slots=True)
class DhRow:
    """One row of a D-H table, rad and m.

    In modified tables alpha and a are those of link i-1 (they come before the joint), in standard ones of link i.
    theta_rad and d_m add to the joint value: an offset for the moving one, the constant for the other.
    """

    alpha_rad: float = 0.0
    a_m: float = 0.0
    d_m: float = 0.0
    theta_rad: float = 0.0
    joint: Joint = field(default_factory=lambda: Joint(""))


def _named(rows: Sequence[DhRow]) -> tuple[Joint, ...]:
    if not rows:
        raise RobotError("a D-H table needs at least one row")
    return tuple(
        r.joint if r.joint.name else Joint(f"joint{i}", r.joint.kind, r.joint.lower, r.joint.upper, r.joint.speed)
        for i, r in enumerate(rows, start=1)
    )


def modified_dh(name: str, rows: Sequence[DhRow], T_last_tool: FloatArray | None = None) -> Chain:
    """Chain of ``Rx(alpha) Tx(a) Rz(theta) Tz(d)`` (Craig; the grape source's eq. (1)), then the tool."""
    joints = _named(rows)
    fixed = np.empty((len(rows) + 1, 4, 4))
    for i, r in enumerate(rows):
        fixed[i] = rot_x(r.alpha_rad) @ translation(r.a_m, 0, r.d_m) @ rot_z(r.theta_rad)
    fixed[-1] = np.eye(4) if T_last_tool is None else T_last_tool
    return Chain(name, joints, fixed)


def standard_dh(
    name: str, rows: Sequence[DhRow], T_last_tool: FloatArray | None = None, T_base: FloatArray | None = None
) -> Chain:
    """Chain of ``Rz(theta) Tz(d) Tx(a) Rx(alpha)`` (Denavit and Hartenberg), then the tool."""
    joints = _named(rows)
    fixed = np.empty((len(rows) + 1, 4, 4))
    behind = np.eye(4) if T_base is None else T_base
    for i, r in enumerate(rows):
        fixed[i] = behind @ rot_z(r.theta_rad) @ translation(0, 0, r.d_m)
        behind = translation(r.a_m, 0, 0) @ rot_x(r.alpha_rad)
    fixed[-1] = behind if T_last_tool is None else behind @ T_last_tool
    return Chain(name, joints, fixed)
