"""How states and pictures show themselves in a notebook, and states as columns for numpy and pandas."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from server import wire

Column = npt.NDArray[Any]
ANGLES = ("theta1_right", "theta2_right", "theta3_right", "theta1_left", "theta2_left", "theta3_left", "T1", "T2")


class Jpeg(bytes):
    """A JPEG picture; a notebook draws it."""

    def _repr_html_(self) -> str:
        return f'<img alt="picture" src="data:image/jpeg;base64,{base64.b64encode(self).decode()}">'

    def __repr__(self) -> str:
        return f"Jpeg of {len(self)} bytes"


def columns(states: Iterable[wire.State]) -> dict[str, Column]:
    """States as named columns of equal length: t and position_s [s], angles [deg] (NaN = unknown), zone, mode,
    engaged, base x and y [m] and yaw [rad]. ``pandas.DataFrame(columns(states))`` is a table."""
    rows = list(states)
    numbers: dict[str, list[float | None]] = {
        "t": [s.t for s in rows],
        "position_s": [s.source.position_s if s.source else None for s in rows],
        **{name: [getattr(s.angles, name) for s in rows] for name in ANGLES},
        "x_m": [s.robot.base.x for s in rows],
        "y_m": [s.robot.base.y for s in rows],
        "yaw_rad": [s.robot.base.yaw for s in rows],
    }
    table: dict[str, Column] = {name: np.array(values, dtype=np.float64) for name, values in numbers.items()}
    table |= {name: np.array([getattr(s, name) for s in rows]) for name in ("zone", "mode", "engaged")}
    return table


def state_html(state: wire.State) -> str:
    """A state as a small table."""
    angles, robot, source = state.angles, state.robot, state.source
    rows = {
        "source": f"{source.uri} at {source.position_s:.1f} s" if source else "none",
        "mode, zone": f"{state.mode}, {state.zone}{', engaged' if state.engaged else ''}",
        "reasons": ", ".join(state.reasons) or "none",
        "hands": f"right {state.hands.right}, left {state.hands.left}",
        "right arm [deg]": _degrees(angles.theta1_right, angles.theta2_right, angles.theta3_right),
        "left arm [deg]": _degrees(angles.theta1_left, angles.theta2_left, angles.theta3_left),
        "robot": f"x {robot.base.x:.2f} m, y {robot.base.y:.2f} m, {robot.drive_m_s:.2f} m/s"
        + (", EMERGENCY STOP" if robot.estop else ""),
    }
    return table_html(rows)


def table_html(rows: dict[str, str]) -> str:
    """Names and values as an HTML table."""
    cells = (f"<tr><th style='text-align:left'>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in rows.items())
    return f"<table>{''.join(cells)}</table>"


def client_html(url: str, state: wire.State, access: wire.Access) -> str:
    """A client at a glance: where, who, who commands, and the state."""
    holder = access.lease.holder
    who = f"{access.you.name} ({access.you.role})" if access.you else "nobody; a token is needed"
    lease = "you" if access.holds_lease else holder.name if holder else "nobody"
    return table_html({"server": url, "you": who, "in control": lease}) + state_html(state)


def _degrees(*values: float | None) -> str:
    return ", ".join("?" if value is None else f"{value:.1f}" for value in values)
