"""A robot behind a serial servo controller: the same limiter as the simulation's, whole degrees out, no feedback."""

from __future__ import annotations

import time
from dataclasses import replace
from math import cos, isfinite, sin

import numpy as np
import numpy.typing as npt

from robot_sim.actuators import JOINTS
from robot_sim.commands import Liquid, RobotCommand
from robot_sim.config import RobotConfig
from robot_sim.errors import RobotError
from robot_sim.events import RobotEvent
from robot_sim.limiter import advance, home_setpoints, latch_estop, resolve
from robot_sim.link.serial_port import SerialLines
from robot_sim.link.servo_protocol import (
    NO_VALVE,
    SEQUENCES,
    Move,
    Request,
    Verb,
    channel_value,
    decode_reply,
    encode_request,
    joint_position,
)
from robot_sim.metrics import RunMetrics, moved_on
from robot_sim.plants import Fruit
from robot_sim.primitives import Primitive
from robot_sim.reasons import RobotReason
from robot_sim.spray import LIQUIDS
from robot_sim.state import RobotState
from robot_sim.urdf import robot_urdf
from robot_sim.urdf_parts_chassis import track_offset_m

TICK_S = 1.0 / 240.0
"""The limiter's tick, as in the simulation."""


class SerialRobot:
    """Drives the controller at a serial port; what it acknowledged is taken as where the robot is.

    A line that is not acknowledged is sent again with the same number; after ``serial.lost_after_s`` without an
    answer the emergency stop is latched with ``link.lost``, and the controller's own watchdog stops the robot.
    """

    seed = 0

    def __init__(self, path: str, config: RobotConfig | None = None) -> None:
        """Open the port and ask the controller for an answer. Raises RobotError when nobody answers."""
        self.config = config or RobotConfig()
        self._lines = SerialLines(path, self.config.serial.baud)
        self._sequence = 0
        self._setpoints = home_setpoints(self.config)
        self._sent: dict[int, int] = {}
        self._x_m = self._y_m = self._yaw_rad = self._time_s = self._carried_s = 0.0
        self._heard_s = time.monotonic()
        self._reasons: tuple[str, ...] = ()
        self._metrics, self._last = RunMetrics(), self.state()
        if (fault := self._ask("Q")) is not None:
            self._lines.close()
            raise RobotError(
                f"no servo controller answers at {path} ({fault}); check cable, power and {self.config.serial.baud} "
                "baud, or serve with --robot pybullet:"
            )

    @property
    def urdf(self) -> str:
        """The robot's URDF text."""
        return robot_urdf(self.config)

    def scenery(self) -> tuple[Primitive, ...]:
        """Nothing is known of the surroundings."""
        return ()

    @property
    def fruits(self) -> tuple[Fruit, ...]:
        """Nobody sees the crop."""
        return ()

    def step(self, command: RobotCommand, dt_s: float) -> RobotState:
        """Limit a command over ``dt_s`` seconds, send where that leads, report. Raises RobotError for a bad time."""
        if not (isfinite(dt_s) and dt_s >= 0.0):
            raise RobotError(f"the time step must be a finite number of seconds >= 0, got {dt_s}")
        due = self._carried_s + dt_s
        ticks = int(due / TICK_S + 1e-6)
        self._carried_s = due - ticks * TICK_S
        goals = resolve(command, self.config)
        reasons = dict.fromkeys(str(r) for r in goals.reasons)
        for _ in range(ticks):
            self._setpoints, more = advance(self._setpoints, goals, TICK_S, self.config)
            reasons |= dict.fromkeys(str(r) for r in more)
        self._time_s += ticks * TICK_S
        fault = self._send()
        if fault is None:
            self._roll(ticks * TICK_S)
        else:
            reasons[str(fault)] = None
            if time.monotonic() - self._heard_s > self.config.serial.lost_after_s:
                self._setpoints = latch_estop(self._setpoints, True)
                reasons[str(RobotReason.LINK_LOST)] = None
        self._reasons = tuple(reasons)
        state = self.state()
        self._metrics = moved_on(self._metrics, self._last, state, 0.0, (), frozenset())
        self._last = state
        return state

    def state(self) -> RobotState:
        """The robot as the controller last acknowledged it."""
        s = self._setpoints
        targets = dict(zip(JOINTS, s.position, strict=True))
        known = {JOINTS[c]: joint_position(JOINTS[c], value) for c, value in self._sent.items()}
        return RobotState(
            sim_time_s=self._time_s,
            base_x_m=self._x_m,
            base_y_m=self._y_m,
            base_yaw_rad=self._yaw_rad,
            drive_m_s=s.drive_m_s,
            turn_rad_s=s.turn_rad_s,
            joint_rad=targets | known,
            target_rad=targets,
            gripper_open=s.gripper_open,
            cutter_closed=s.cutter_closed,
            spray_on=s.spray_on,
            liquid=s.liquid,
            estop=s.estop,
            reasons=self._reasons,
        )

    def reset(self) -> RobotState:
        """A real robot cannot be put back: it stands still where it is and takes this place as its origin."""
        self._setpoints = replace(
            home_setpoints(self.config), position=self._setpoints.position, estop=self._setpoints.estop
        )
        self._x_m = self._y_m = self._yaw_rad = self._time_s = self._carried_s = 0.0
        self._metrics, self._last = RunMetrics(), self.state()
        return self._last

    def estop(self) -> RobotState:
        """Latch the emergency stop here and in the controller."""
        self._setpoints = latch_estop(self._setpoints, True)
        self._note(self._ask("X"))
        return self.state()

    def estop_reset(self) -> RobotState:
        """Release the emergency stop; it stays latched when the controller does not answer."""
        fault = self._ask("R")
        self._note(fault)
        if fault is None:
            self._setpoints = latch_estop(self._setpoints, False)
        return self.state()

    @property
    def events(self) -> tuple[RobotEvent, ...]:
        """Nothing tells of any."""
        return ()

    def coverage(self, liquid: Liquid, low_m: npt.ArrayLike, high_m: npt.ArrayLike) -> float:
        """Nothing tells how wet leaves are."""
        del liquid, low_m, high_m
        return 0.0

    def metrics(self) -> RunMetrics:
        """Time, distance and turning by dead reckoning; nothing else is measured."""
        return self._metrics

    def wet_leaves(self) -> dict[str, tuple[float, float, float]]:
        """Nobody measures it."""
        return {}

    def head_camera_rgb(self, width: int = 320, height: int = 240) -> npt.NDArray[np.uint8]:
        """Grey: the controller has no camera."""
        return np.full((height, width, 3), 128, dtype=np.uint8)

    def close(self) -> None:
        """Stop tracks and valve and free the port."""
        self._ask("M", Move())
        self._lines.close()

    def _send(self) -> RobotReason | None:
        """Send what changed; returns what went wrong."""
        s = self._setpoints
        values = {c: channel_value(name, q) for c, (name, q) in enumerate(zip(JOINTS, s.position, strict=True))}
        changed = {c: v for c, v in values.items() if self._sent.get(c) != v}
        half = track_offset_m(self.config.chassis)
        left, right = s.drive_m_s - s.turn_rad_s * half, s.drive_m_s + s.turn_rad_s * half
        valve = LIQUIDS.index(s.liquid) if s.spray_on else NO_VALVE
        fault = self._ask("M", Move(round(1000 * left), round(1000 * right), valve, changed))
        if fault is None:
            self._sent |= changed
        return fault

    def _ask(self, verb: Verb, move: Move | None = None) -> RobotReason | None:
        """One request, repeated until it is acknowledged or given up; returns what went wrong."""
        limits = self.config.serial
        self._sequence = (self._sequence + 1) % SEQUENCES
        line = encode_request(Request(self._sequence, verb, move))
        for _ in range(1 + limits.retries):
            if not self._lines.send(line):
                return RobotReason.LINK_TIMEOUT
            until_s = time.monotonic() + limits.ack_timeout_s
            while (got := self._lines.receive(until_s)) is not None:
                reply = decode_reply(got)
                # an answer to an earlier line came late
                if reply is None or reply.sequence != self._sequence:
                    continue
                self._heard_s = time.monotonic()
                if not reply.error:
                    return None
                if reply.error != "checksum":
                    return RobotReason.LINK_REFUSED
                break
        return RobotReason.LINK_TIMEOUT

    def _note(self, fault: RobotReason | None) -> None:
        self._reasons = () if fault is None else (str(fault),)

    def _roll(self, dt_s: float) -> None:
        """Dead reckoning from the speeds that were acknowledged."""
        s = self._setpoints
        middle = self._yaw_rad + 0.5 * s.turn_rad_s * dt_s
        self._x_m += s.drive_m_s * cos(middle) * dt_s
        self._y_m += s.drive_m_s * sin(middle) * dt_s
        self._yaw_rad += s.turn_rad_s * dt_s
