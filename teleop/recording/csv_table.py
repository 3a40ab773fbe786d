"""Tracking rows as a table for spreadsheets and statistics: one line per frame, one column per number or word."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from teleop.joints import JOINT_NAMES

ANGLES: Final = (
    *(f"theta{i}_{side}" for side in ("right", "left") for i in (1, 2, 3)),
    "T1",
    "T2",
)
_ARMS: Final = ("right_arm", "left_arm", "rear_arm")
_ARM_ANGLES: Final = ("c1_deg", "c2_deg", "elbow_deg")
_COMMANDS: Final = (
    "drive_m_s",
    "turn_rad_s",
    "lift_m",
    "disc_rad",
    "gripper_open",
    "cutter_closed",
    "spray_on",
    "liquid",
)


def csv_columns() -> list[str]:
    """Names of the columns: joints in camera axes [m], angles and arm commands [deg]; words last."""
    joints = [f"{name}_{axis}" for name in JOINT_NAMES for axis in ("x_m", "y_m", "z_m", "confidence")]
    arms = [f"command_{arm}_{angle}" for arm in _ARMS for angle in _ARM_ANGLES]
    commands = [f"command_{name}" for name in _COMMANDS]
    angles = [f"{name}_deg" for name in ANGLES]
    return ["t_s", *joints, *angles, *arms, *commands, "hand_right", "hand_left", "zone", "mode", "reasons"]


def csv_values(row: Mapping[str, Any]) -> list[Any]:
    """One row of ``teleop track`` under these columns; no answer is an empty cell."""
    values: list[Any] = [row["t"]]
    for name in JOINT_NAMES:
        values += [*(row["joints"].get(name) or (None, None, None)), row["confidence"].get(name)]
    values += [row["angles"].get(name) for name in ANGLES]
    command = row["command"]
    for arm in _ARMS:
        target = command.get(arm) or {}
        values += [target.get(angle) for angle in _ARM_ANGLES]
    values += [_word(command.get(name)) for name in _COMMANDS]
    hands = row["hands"]
    return [*values, hands.get("right"), hands.get("left"), row["zone"], row["mode"], " ".join(row["reasons"])]


def _word(value: Any) -> Any:
    return int(value) if isinstance(value, bool) else value
