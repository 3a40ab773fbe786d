"""A robot without physics that does at once what it is told, and a fruit that obeys the rules of picking."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from robot_sim.arm_angles import joint_rad
from robot_sim.commands import RobotCommand
from robot_sim.config import RobotConfig
from robot_sim.state import RobotState

PERIOD_S = 1.0 / 30.0


@dataclass
class IdealRobot:
    """grips: whether the gripper finds the fruit. cuts: whether the blades find its peduncle. slips_after_s: when the
    fruit falls out of the gripper. stuck: the arms do not follow."""

    state: RobotState
    config: RobotConfig
    fruit: str
    grips: bool = True
    cuts: bool = True
    boxes: bool = True
    stuck: bool = False
    slips: bool = False
    commands: list[RobotCommand] = field(default_factory=list)

    def follow(self, command: RobotCommand) -> RobotState:
        self.commands.append(command)
        joints = dict(self.state.joint_rad)
        if not self.stuck:
            for arm in ("right", "left"):
                if (target := command.arm(arm)) is not None:  # type: ignore[arg-type]
                    joints |= joint_rad(target, arm)  # type: ignore[arg-type]
        if command.lift_m is not None:
            joints["lift"] = command.lift_m
        cutter = self.config.tool.cutter.upper if command.cutter_closed else 0.0
        closing = cutter > joints["cutter"]
        joints["cutter"] = cutter
        gripper_open = self.state.gripper_open if command.gripper_open is None else command.gripper_open
        fruits = dict(self.state.fruits)
        if not gripper_open and self.grips:
            fruits[self.fruit] = "held"
        elif gripper_open and self.fruit in fruits:
            fruits[self.fruit] = "boxed" if self.boxes else "dropped"
        if self.slips and fruits.get(self.fruit) == "held" and command.right_arm is not None:
            fruits[self.fruit] = "dropped"
        drive = command.drive_m_s
        self.state = replace(
            self.state,
            sim_time_s=self.state.sim_time_s + PERIOD_S,
            base_x_m=self.state.base_x_m + drive * PERIOD_S * math.cos(self.state.base_yaw_rad),
            drive_m_s=drive,
            joint_rad=joints,
            target_rad=joints,
            gripper_open=gripper_open,
            cutter_closed=bool(command.cutter_closed),
            fruits=fruits,
            reasons=("pick.nothing_cut",) if closing and not self.cuts else (),
        )
        return self.state
