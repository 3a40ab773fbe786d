"""What a real servo makes of a set-point: whole degrees, and the play of its gears. Pure."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, radians

from robot_sim.actuators import JOINT_INDEX
from robot_sim.arm_angles import arm_joint_names
from robot_sim.commands import ARM_NAMES
from robot_sim.config import ServoConfig

SERVOS = tuple(JOINT_INDEX[name] for arm in ARM_NAMES for name in arm_joint_names(arm))
"""The arms' joints; lift, disc and tools have drives of their own."""


def driven(before: Sequence[float], setpoints: Sequence[float], config: ServoConfig) -> tuple[float, ...]:
    """Where the joints' outputs are driven, one value per JOINTS.

    before: the outputs so far. A gear with play b follows its motor only when the motor has crossed the gap: the output
    stays while it is within b / 2 of it (play operator of hysteresis).
    """
    out = list(setpoints)
    half = 0.5 * config.backlash_rad
    for i in SERVOS:
        motor = radians(round(degrees(setpoints[i]))) if config.whole_degrees else setpoints[i]
        out[i] = min(max(before[i], motor - half), motor + half)
    return tuple(out)


def exact(config: ServoConfig) -> bool:
    """Whether outputs are the set-points themselves."""
    return not config.whole_degrees and config.backlash_rad == 0.0
