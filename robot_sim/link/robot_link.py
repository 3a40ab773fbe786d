"""The interface between those who command and a robot, simulated or real."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import numpy.typing as npt

from robot_sim.commands import Liquid, RobotCommand
from robot_sim.config import RobotConfig
from robot_sim.events import RobotEvent
from robot_sim.metrics import RunMetrics
from robot_sim.plants import Fruit
from robot_sim.primitives import Primitive
from robot_sim.state import RobotState


class RobotLink(Protocol):
    """One robot. Not thread-safe. Faults of the link come back as reason codes, never as exceptions."""

    @property
    def config(self) -> RobotConfig:
        """Dimensions and limits."""

    @property
    def seed(self) -> int:
        """Of the greenhouse; 0 for a real one."""

    @property
    def urdf(self) -> str:
        """The robot's URDF text."""

    def scenery(self) -> tuple[Primitive, ...]:
        """What surrounds the robot, as far as the link knows."""

    @property
    def fruits(self) -> tuple[Fruit, ...]:
        """All fruit as it grew, as far as the link knows; a real robot needs somebody who sees it."""

    def step(self, command: RobotCommand, dt_s: float) -> RobotState:
        """Follow a command for ``dt_s`` seconds and report."""

    def state(self) -> RobotState:
        """The robot as it stands."""

    def reset(self) -> RobotState:
        """Back to the start, as far as the robot can be put there."""

    def estop(self) -> RobotState:
        """Latch the emergency stop."""

    def estop_reset(self) -> RobotState:
        """Release the emergency stop."""

    @property
    def events(self) -> tuple[RobotEvent, ...]:
        """What happened in the last step, as far as the link can tell."""

    def coverage(self, liquid: Liquid, low_m: npt.ArrayLike, high_m: npt.ArrayLike) -> float:
        """Share 0..1 of the leaf area between two corners (3,) [m] that is wet with a liquid, as far as it is known."""

    def metrics(self) -> RunMetrics:
        """What the run has come to since the last reset, as far as the link can tell."""

    def wet_leaves(self) -> dict[str, tuple[float, float, float]]:
        """Leaf -> share wet with each liquid; empty where nobody measures it."""

    def head_camera_rgb(self, width: int = 320, height: int = 240) -> npt.NDArray[np.uint8]:
        """What the head camera sees, (height, width, 3) uint8 RGB; grey where there is none."""

    def close(self) -> None:
        """Leave the robot standing and free the link."""
