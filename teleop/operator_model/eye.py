"""Reading places off the 3-D view: the robot's hands, a fruit, leaves; late and with a person's error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin
from typing import Final

import numpy as np

from robot_sim.arm_angles import arm_target
from robot_sim.commands import ArmName, ArmTarget
from robot_sim.config import RobotConfig
from robot_sim.reach import hand_in_base
from robot_sim.urdf_parts_tools import GRIP_M
from teleop.operator_model.console import ConsoleView, Scenery
from teleop.people.rig import Floats

_WAVES_HZ: Final = np.array([0.21, 0.47, 0.83])


@dataclass(frozen=True, slots=True, eq=False)
class Eye:
    """How well somebody reads a distance off the screen. bias_m (3,): always; wander_m: standard deviation beside it.

    The error wanders slowly: looking again at once does not help.
    """

    bias_m: Floats
    wander_m: float
    phase: Floats

    def error_m(self, t_s: float) -> Floats:
        """(3,) by which distances are misread at a time."""
        waves = np.sin(2 * np.pi * _WAVES_HZ * t_s + self.phase)
        return np.asarray(self.bias_m + self.wander_m * np.sqrt(2.0 / len(_WAVES_HZ)) * waves.sum(axis=1))


def new_eye(rng: np.random.Generator, bias_m: float, wander_m: float) -> Eye:
    """Somebody's eye."""
    return Eye(rng.normal(0.0, bias_m, 3), wander_m, rng.uniform(0, 2 * np.pi, (3, len(_WAVES_HZ))))


def latest(views: Sequence[ConsoleView], now_s: float, late_s: float) -> ConsoleView | None:
    """The newest painting that has reached the operator's mind."""
    for view in reversed(views):
        if view.t_s <= now_s - late_s + 1e-9:
            return view
    return None


def in_world(base: tuple[float, float, float], xyz_m: Floats) -> Floats:
    """A point (3,) of the chassis' axes in world axes."""
    x, y, yaw = base
    return np.array(
        [x + cos(yaw) * xyz_m[0] - sin(yaw) * xyz_m[1], y + sin(yaw) * xyz_m[0] + cos(yaw) * xyz_m[1], xyz_m[2]]
    )


def hand_m(view: ConsoleView, arm: ArmName, target: ArmTarget, beyond_m: float, config: RobotConfig) -> Floats:
    """(3,) where the end of an arm is drawn, or would be at a target; world axes."""
    at = hand_in_base(arm, target, beyond_m, view.joint_rad["lift"], view.joint_rad["disc"], config)
    return in_world(view.base, at)


def drawn_arm(view: ConsoleView, arm: ArmName) -> ArmTarget:
    """How an arm is drawn."""
    return arm_target(view.joint_rad, arm)


def gripper_m(view: ConsoleView, config: RobotConfig) -> Floats:
    """(3,) middle of the pads, as drawn."""
    return hand_m(view, "right", drawn_arm(view, "right"), GRIP_M, config)


def fruit_m(view: ConsoleView, scenery: Scenery, fruit: str) -> Floats:
    """(3,) middle of a fruit, as drawn."""
    return np.array(view.moved[fruit][:3] if fruit in view.moved else scenery[fruit].xyz_m)


def grip_point_m(view: ConsoleView, scenery: Scenery, fruit: str, config: RobotConfig) -> Floats:
    """(3,) where a fruit is best gripped: a little under its top, as drawn."""
    top_m = 0.5 * scenery[fruit].size_m[-1]
    return fruit_m(view, scenery, fruit) + np.array([0.0, 0.0, top_m - config.pick.grip_under_top_m])
