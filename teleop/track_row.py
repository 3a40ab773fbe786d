"""One frame's results as the JSON row of ``teleop track`` and of the topic ``/teleop/track``."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from robot_sim.commands import RobotCommand
from teleop.intent_types import BodyAngles, Hands, Intent
from teleop.joints import JOINT_NAMES
from teleop.skeleton import Track


def _number(value: float | None, digits: int) -> float | None:
    return None if value is None or not math.isfinite(value) else round(float(value), digits)


def angles_row(angles: BodyAngles) -> dict[str, float | None]:
    """Angles in degrees, continuous, None where there is no answer."""
    row: dict[str, float | None] = {}
    for side, arm in (("right", angles.right), ("left", angles.left)):
        for i, value in enumerate((arm.theta1_deg, arm.theta2_deg, arm.theta3_deg), start=1):
            row[f"theta{i}_{side}"] = _number(value, 3)
    return row | {"T1": _number(angles.T1_deg, 3), "T2": _number(angles.T2_deg, 3)}


def hands_row(hands: Hands) -> dict[str, str]:
    """What both hands show."""
    return {"right": str(hands.right), "left": str(hands.left)}


def command_row(command: RobotCommand) -> dict[str, Any]:
    """The command without its time and reasons, which the row has of its own."""
    row = dataclasses.asdict(command)
    del row["t_ns"], row["reasons"]
    return {key: str(value) if isinstance(value, str) else value for key, value in row.items()}


def joints_row(track: Track) -> tuple[dict[str, list[float] | None], dict[str, float]]:
    """Joints in camera axes [m] and their confidence 0..1, by name."""
    if track.skeleton is None:
        return dict.fromkeys(JOINT_NAMES), dict.fromkeys(JOINT_NAMES, 0.0)
    joints: dict[str, list[float] | None] = {}
    confidence: dict[str, float] = {}
    for i, name in enumerate(JOINT_NAMES):
        p = track.skeleton.joints_m[i]
        known = all(math.isfinite(c) for c in p)
        joints[name] = [round(float(c), 5) for c in p] if known else None
        c = float(track.skeleton.confidence[i])
        confidence[name] = round(min(1.0, max(0.0, c)), 4) if known and math.isfinite(c) else 0.0
    return joints, confidence


def track_row(track: Track, intent: Intent, command: RobotCommand) -> dict[str, Any]:
    """The row as the architecture fixes it: JSON types only, never NaN, null where there is no answer."""
    joints, confidence = joints_row(track)
    return {
        "t": track.t_ns / 1e9,
        "joints": joints,
        "confidence": confidence,
        "angles": angles_row(intent.angles),
        "hands": hands_row(intent.hands),
        "zone": str(intent.zone),
        "mode": str(intent.mode),
        "command": command_row(command),
        "reasons": list(command.reasons),
    }
