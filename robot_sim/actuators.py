"""The driven joints in one fixed order: what the limiter, the URDF and the physics agree on."""

from __future__ import annotations

from dataclasses import dataclass

from robot_sim.arm_angles import ARM_AXES
from robot_sim.commands import ARM_NAMES
from robot_sim.config import AxisLimits, RobotConfig
from robot_sim.derived import derived

JOINTS: tuple[str, ...] = (
    "lift",
    "disc",
    *(f"{arm}_{axis}" for arm in ARM_NAMES for axis in ARM_AXES),
    "gripper_left",
    "gripper_right",
    "cutter",
    "head_pan",
)
"""URDF names of the position-controlled joints."""

JOINT_INDEX: dict[str, int] = {name: i for i, name in enumerate(JOINTS)}

WHEELS: tuple[str, ...] = tuple(f"wheel_{side}_{i}" for side in ("left", "right") for i in range(3))
"""URDF names of the road wheels under the tracks, front to back."""


@dataclass(frozen=True, slots=True)
class Axis:
    """One driven joint with its limits and where it stands at the start [rad or m]."""

    name: str
    limits: AxisLimits
    home: float


@derived
def axes(config: RobotConfig) -> tuple[Axis, ...]:
    """All driven joints in the order of JOINTS."""
    arm, body, tool = config.arm, config.body, config.tool
    limits = {"lift": body.lift, "disc": body.disc, "head_pan": body.head_pan, "cutter": tool.cutter}
    limits |= {"gripper_left": tool.jaw, "gripper_right": tool.jaw}
    limits |= {f"{a}_{x}": getattr(arm, x) for a in ARM_NAMES for x in ARM_AXES}
    home = {"lift": body.home_lift_m, "gripper_left": tool.jaw.upper, "gripper_right": tool.jaw.upper}
    return tuple(Axis(n, limits[n], min(max(home.get(n, 0.0), limits[n].lower), limits[n].upper)) for n in JOINTS)
