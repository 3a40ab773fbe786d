"""Inputs of the pipeline as plain JSON and back, exactly: numbers keep every bit."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any

from robot_sim.commands import ArmTarget, Liquid
from teleop.errors import RecordingError
from teleop.inputs import Inputs, PickAsk, RobotRequest
from teleop.reasons import Reason

_ARMS = ("right_arm", "left_arm", "rear_arm")
_SWITCHES = ("gripper_open", "cutter_closed", "spray_on", "head_camera_sweep")
_FLAGS = ("engage", "disengage", "estop", "estop_reset", "source_failed")


def inputs_to_json(inputs: Inputs) -> dict[str, Any]:
    """Inputs as a JSON object. A number that is none, which the kernel refuses, becomes the text "nan" or "inf"."""
    row = {name: getattr(inputs, name) for name in _FLAGS} | {"receive_t_ns": inputs.receive_t_ns}
    request = None if inputs.request is None else _plain(asdict(inputs.request))
    picks = {"picks": [asdict(ask) for ask in inputs.picks]} if inputs.picks else {}
    return row | {"request": request} | picks


def inputs_from_json(row: Mapping[str, Any]) -> Inputs:
    """The Inputs that were written. Raises RecordingError when the object does not hold them."""
    try:
        flags = {name: _boolean(row[name]) for name in _FLAGS}
        receive = row["receive_t_ns"]
        request = row["request"]
        return Inputs(
            flags["engage"],
            flags["disengage"],
            flags["estop"],
            flags["estop_reset"],
            None if request is None else _request(request),
            tuple(_pick(ask) for ask in row.get("picks", ())),
            None if receive is None else int(receive),
            flags["source_failed"],
        )
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise RecordingError(f"a row of /teleop/inputs cannot be read: {error!r}") from None


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(v) for key, v in value.items()}
    if isinstance(value, float) and not math.isfinite(value):
        return repr(value)
    return value


def _request(row: Mapping[str, Any]) -> RobotRequest:
    known = {f.name for f in fields(RobotRequest)}
    unknown = sorted(set(row) - known)
    if unknown:
        raise ValueError(f"unknown request {', '.join(unknown)}")
    return RobotRequest(**{name: _value(name, value) for name, value in row.items() if value is not None})


def _pick(row: Mapping[str, Any]) -> PickAsk:
    action, fruit = row["action"], row["fruit"]
    if action not in ("start", "confirm", "cancel"):
        raise ValueError(f"unknown action {action!r}")
    chosen = None if fruit is None else str(fruit)
    return PickAsk(str(row["id"]), action, chosen, _boolean(row["preview"]), Reason(row["reason"]))


def _value(name: str, value: Any) -> Any:
    if name in _ARMS:
        return ArmTarget(*(float(value[angle]) for angle in ("c1_deg", "c2_deg", "elbow_deg")))
    if name in _SWITCHES:
        return _boolean(value)
    return Liquid(value) if name == "liquid" else float(value)


def _boolean(value: Any) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"expected true or false, got {value!r}")
    return value
