"""What the robot is told: one frozen RobotCommand per frame.

Axes (robot): x forward, y left, z up; turning left is positive. Arm angles follow the source
(spec/teleoperation, section 4): zero is the arm hanging down, 180 deg is a straight elbow.
``None`` anywhere means "keep what you have": it is the hold.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

ArmName = Literal["right", "left", "rear"]
ARM_NAMES: tuple[ArmName, ...] = ("right", "left", "rear")


class Liquid(StrEnum):
    """The three tanks of the sprayer, in the order the left hand steps through them."""

    WATER = "water"
    NUTRIENT = "nutrient"
    PESTICIDE = "pesticide"


@dataclass(frozen=True, slots=True)
class ArmTarget:
    """Servo set-points of one arm, in degrees as the source's servo controller takes them.

    c1_deg: shoulder axis C1, swing in the sagittal (y-z) plane, theta2, forward positive.
    c2_deg: shoulder axis C2, swing in the frontal (x-y) plane, theta1, outward positive.
    elbow_deg: inner elbow angle theta3, 180 = straight.
    """

    c1_deg: float
    c2_deg: float
    elbow_deg: float


@dataclass(frozen=True, slots=True)
class RobotCommand:
    """The safety kernel's output. Speeds are always explicit; everything else None = hold."""

    t_ns: int
    drive_m_s: float = 0.0
    turn_rad_s: float = 0.0
    right_arm: ArmTarget | None = None
    left_arm: ArmTarget | None = None
    rear_arm: ArmTarget | None = None
    lift_m: float | None = None
    disc_rad: float | None = None
    gripper_open: bool | None = None
    cutter_closed: bool | None = None
    spray_on: bool = False
    liquid: Liquid | None = None
    head_camera_sweep: bool = False
    stand_still: bool = False
    """Drop every goal not yet reached and brake; without it, None lets a joint finish its way to its last target."""
    reasons: tuple[str, ...] = ()
    """Reason codes of everything that was clamped, held, refused or stopped (robot_sim.reasons, teleop.reasons)."""

    def arm(self, name: ArmName) -> ArmTarget | None:
        """The target of one arm, or None when it holds."""
        return {"right": self.right_arm, "left": self.left_arm, "rear": self.rear_arm}[name]


def stop_command(t_ns: int, *reasons: str) -> RobotCommand:
    """Everything stands still: chassis and spray off, all else held."""
    return RobotCommand(t_ns=t_ns, stand_still=True, reasons=reasons)
