"""Configuration of the assisted pick: how it reaches, how far it may correct, how long it waits."""

from __future__ import annotations

from pydantic import Field

from robot_sim.section import RobotSection


class PickConfig(RobotSection):
    """The robot picks by itself, stage by stage, while the operator keeps both hands closed."""

    speed_share: float = Field(
        default=0.6, gt=0.05, le=1.0, description="share of the arms' highest speeds and accelerations [1]; choice"
    )
    approach_m: float = Field(
        default=0.11, ge=0.05, le=0.3, description="straight last stretch to the fruit [m]; choice: a finger and a half"
    )
    grip_under_top_m: float = Field(
        default=0.05, ge=0.01, le=0.15, description="where the pads close, under the fruit's top [m]; choice"
    )
    tilt_rad: float = Field(
        default=0.42, ge=0.05, le=0.8, description="the forearm may leave the level by this much at the fruit [rad]"
    )
    plant_gap_m: float = Field(
        default=0.006, ge=0.0, le=0.1, description="arms keep this far from other fruit, stems, gutters [m]; choice"
    )
    arm_gap_m: float = Field(
        default=0.006, ge=0.0, le=0.1, description="arms keep this much more from each other than they must [m]; choice"
    )
    correction_m: float = Field(
        default=0.4, ge=0.0, le=2.0, description="the chassis drives at most this far by itself [m]; choice: a plant"
    )
    drive_m_s: float = Field(default=0.2, gt=0.0, le=1.0, description="at this speed [m/s]; choice")
    arrived_m: float = Field(
        default=0.004, gt=0.0, le=0.05, description="chassis and lift have arrived within this [m]; choice"
    )
    aligned_rad: float = Field(
        default=0.12, ge=0.0, le=0.8, description="it drives by itself only this nearly along the row [rad]; 7 deg"
    )
    hold_s: float = Field(default=0.25, ge=0.0, le=5.0, description="held this long before the cut [s]; choice")
    patience_s: float = Field(
        default=2.0, ge=0.2, le=30.0, description="a stage that makes no progress for so long has failed [s]; choice"
    )
