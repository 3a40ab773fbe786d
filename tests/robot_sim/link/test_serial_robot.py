"""The serial link over a real pseudo-terminal, with a controller that drops and corrupts bytes."""

from __future__ import annotations

import math
import os
import random
import threading
import time
import tty
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from robot_sim.actuators import JOINT_INDEX, axes
from robot_sim.commands import ArmTarget, Liquid, RobotCommand
from robot_sim.config import RobotConfig, SerialConfig
from robot_sim.errors import RobotError
from robot_sim.link import open_robot
from robot_sim.link.serial_robot import SerialRobot
from robot_sim.link.servo_protocol import Move, Request, encode_request
from robot_sim.link.simulated_controller import Controller, hear, watch
from robot_sim.reasons import RobotReason

FRAME_S = 1.0 / 30.0
CONFIG = RobotConfig(serial=SerialConfig(ack_timeout_s=0.2, retries=10, lost_after_s=0.05))


class Bench:
    """A controller at the other end of a pseudo-terminal. dropped, damaged: share of bytes; mute: answers nothing."""

    def __init__(self, dropped: float = 0.0, damaged: float = 0.0) -> None:
        self.dropped, self.damaged, self.mute = dropped, damaged, False
        self.controller = Controller()
        self.spoilt = 0
        self._noise = random.Random(3)
        self._master, slave = os.openpty()
        tty.setraw(slave)
        self.path = os.ttyname(slave)
        self._slave = slave
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def _channel(self, data: bytes) -> bytes:
        out = bytearray()
        for byte in data:
            if self._noise.random() < self.dropped:
                self.spoilt += 1
                continue
            if self._noise.random() < self.damaged:
                self.spoilt += 1
                byte ^= 1 << self._noise.randrange(8)
            out.append(byte)
        return bytes(out)

    def _serve(self) -> None:
        waiting = b""
        while True:
            try:
                data = os.read(self._master, 256)
            except OSError:
                return
            if data == b"\x04":
                return
            waiting += self._channel(data)
            *lines, waiting = waiting.split(b"\n")
            for line in lines:
                if not self.mute:
                    self.controller, answer = hear(self.controller, line + b"\n", time.monotonic(), CONFIG)
                    os.write(self._master, self._channel(answer))

    def close(self) -> None:
        os.write(self._slave, b"\x04")
        self._thread.join(2.0)
        os.close(self._slave)
        os.close(self._master)


@contextmanager
def bench(dropped: float = 0.0, damaged: float = 0.0) -> Iterator[tuple[Bench, SerialRobot]]:
    there = Bench(dropped, damaged)
    robot = SerialRobot(there.path, CONFIG)
    try:
        yield there, robot
    finally:
        there.mute = False
        robot.close()
        there.close()


def test_the_controller_is_told_whole_degrees_inside_the_limits() -> None:
    with bench() as (there, robot):
        command = RobotCommand(t_ns=0, right_arm=ArmTarget(45.4, 14.6, 400.0), lift_m=0.2, spray_on=True)
        for _ in range(60):
            state = robot.step(command, FRAME_S)
        servos = there.controller.servos
        wanted = {"right_c1": 45, "right_c2": 15, "right_elbow": 0, "lift": 200, "gripper_left": 60}
        assert {name: servos[JOINT_INDEX[name]] for name in wanted} == wanted
        assert there.controller.valve == 0
        assert RobotReason.JOINT_LIMIT in state.reasons
        assert math.degrees(state.joint_rad["right_c1"]) == pytest.approx(45.0)
        state = robot.step(RobotCommand(t_ns=0, drive_m_s=0.4, turn_rad_s=0.1, liquid=Liquid.PESTICIDE), 1.0)
        half = 0.5 * (CONFIG.chassis.width_m - CONFIG.chassis.track_width_m)
        assert there.controller.left_mm_s == round(1000 * (0.4 - 0.1 * half))
        assert there.controller.right_mm_s == round(1000 * (0.4 + 0.1 * half))
        assert there.controller.valve == -1 and state.liquid is Liquid.PESTICIDE
        assert 0.2 < state.base_x_m < 0.4
        assert robot.metrics().distance_m == pytest.approx(math.hypot(state.base_x_m, state.base_y_m), rel=0.01)
        robot.reset()
        assert robot.state().base_x_m == robot.metrics().distance_m == 0.0


def test_dropped_and_damaged_bytes_are_made_good() -> None:
    with bench(dropped=0.004, damaged=0.004) as (there, robot):
        for c1 in (90, 0, 60):
            for _ in range(30):
                state = robot.step(RobotCommand(t_ns=0, left_arm=ArmTarget(c1, 30, 120)), FRAME_S)
        assert there.spoilt > 20
        servos = there.controller.servos
        for name, q in state.joint_rad.items():
            if not name.startswith(("lift", "gripper")):
                assert servos[JOINT_INDEX[name]] == round(math.degrees(q)), name
        assert servos[JOINT_INDEX["left_c1"]] == 60
        assert not state.estop


def test_a_controller_that_falls_silent_latches_the_emergency_stop() -> None:
    there = Bench()
    config = CONFIG.model_copy(update={"serial": SerialConfig(ack_timeout_s=0.01, retries=1, lost_after_s=0.05)})
    robot = SerialRobot(there.path, config)
    robot.step(RobotCommand(t_ns=0, drive_m_s=0.3), 0.5)
    moved = robot.state().base_x_m
    there.mute = True
    seen: set[str] = set()
    for _ in range(20):
        state = robot.step(RobotCommand(t_ns=0, drive_m_s=0.3), FRAME_S)
        seen |= set(state.reasons)
    assert {RobotReason.LINK_TIMEOUT, RobotReason.LINK_LOST} <= seen
    assert state.estop and state.base_x_m == moved
    assert robot.estop_reset().estop, "a stop is not released while nobody answers"
    there.mute = False
    assert not robot.estop_reset().estop
    robot.close()
    assert there.controller.left_mm_s == 0
    there.close()


def test_emergency_stop_reaches_the_controller() -> None:
    with bench() as (there, robot):
        robot.step(RobotCommand(t_ns=0, drive_m_s=0.3), 0.5)
        assert robot.estop().estop
        assert there.controller.stopped and there.controller.left_mm_s == 0
        robot.step(RobotCommand(t_ns=0, drive_m_s=0.3, right_arm=ArmTarget(40, 0, 90)), 0.5)
        assert there.controller.right_mm_s == 0
        assert not robot.estop_reset().estop and not there.controller.stopped


def test_the_controller_carries_a_repeated_line_out_once_and_stops_by_itself() -> None:
    line = encode_request(Request(5, "M", Move(200, 200, 1, {2: 30})))
    first, answer = hear(Controller(), line, 1.0, CONFIG)
    again, same = hear(first, line, 1.1, CONFIG)
    assert answer == same and again.done == first.done == 1
    assert watch(again, 1.5).left_mm_s == 200
    silent = watch(again, 1.7)
    assert (silent.left_mm_s, silent.valve, silent.servos) == (0, -1, {2: 30})
    refused, answer = hear(first, encode_request(Request(6, "M", Move(servos={2: 170}))), 1.2, CONFIG)
    assert answer.startswith(b"!6,ER,range") and refused.servos == first.servos
    assert axes(CONFIG)[2].name == "right_c1"


@pytest.mark.parametrize("uri", ["", "serial:", "ros:", "pybullet:gui"])
def test_an_unknown_robot_names_what_is_legal(uri: str) -> None:
    with pytest.raises(RobotError, match="legal: pybullet:"):
        open_robot(uri)


def test_a_port_that_is_not_there_and_one_where_nobody_answers() -> None:
    with pytest.raises(RobotError, match="cannot open the serial port"):
        open_robot("serial:/dev/no-such-port")
    there = Bench()
    there.mute = True
    with pytest.raises(RobotError, match="no servo controller answers"):
        open_robot(f"serial:{there.path}")
    there.close()
