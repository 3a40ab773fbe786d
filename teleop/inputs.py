"""What reaches the pipeline beside the frames: buttons, API requests, receive times, faults of the source."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Literal

from robot_sim.commands import ArmTarget, Liquid
from teleop.reasons import Reason


@dataclass(frozen=True, slots=True)
class RobotRequest:
    """What the console or the API asks of the robot directly; None leaves a thing alone.

    Speeds count for one step only, so a client that goes silent stops the chassis.
    """

    drive_m_s: float | None = None
    turn_rad_s: float | None = None
    right_arm: ArmTarget | None = None
    left_arm: ArmTarget | None = None
    rear_arm: ArmTarget | None = None
    lift_m: float | None = None
    disc_rad: float | None = None
    gripper_open: bool | None = None
    cutter_closed: bool | None = None
    spray_on: bool | None = None
    liquid: Liquid | None = None
    head_camera_sweep: bool | None = None

    @property
    def finite(self) -> bool:
        """Whether every number in it is one."""
        numbers: list[float] = []
        for f in fields(self):
            value = getattr(self, f.name)
            if isinstance(value, ArmTarget):
                numbers += [value.c1_deg, value.c2_deg, value.elbow_deg]
            elif isinstance(value, float):
                numbers.append(value)
        return all(math.isfinite(n) for n in numbers)


@dataclass(frozen=True, slots=True)
class PickAsk:
    """What the console or the API asks of the assisted pick.

    id: of the task. fruit: the one to pick; None takes the nearest ripe one. preview: show the path and wait to be
    confirmed; while an operator is engaged it waits for their left fist in any case. reason: why it is cancelled.
    """

    id: str
    action: Literal["start", "confirm", "cancel"] = "start"
    fruit: str | None = None
    preview: bool = False
    reason: Reason = Reason.ASSIST_CANCELLED


@dataclass(frozen=True, slots=True)
class Inputs:
    """Everything that happened since the last frame.

    engage, disengage, estop, estop_reset: requests of the console or the API; an e-stop wins over all.
    request: direct control. picks: asked of the assisted pick, in order. receive_t_ns: when the frame was received
    (monotonic ns), for live sources only; a replayed frame has none, because its clock may be paused or run fast.
    source_failed: the source says so itself. interrupted: the watchdog stopped the robot since the last frame; it
    follows from the rest and is not recorded.
    """

    engage: bool = False
    disengage: bool = False
    estop: bool = False
    estop_reset: bool = False
    request: RobotRequest | None = None
    picks: tuple[PickAsk, ...] = ()
    receive_t_ns: int | None = None
    source_failed: bool = False
    interrupted: bool = False
