"""Lengths, limits and tool geometry of the three arms; what a source does not print is marked as a choice."""

from __future__ import annotations

from pydantic import Field

from robot_sim.section import RobotSection


class GrapeArmConfig(RobotSection):
    """GSK RB03 with the clamp-hold-cut end effector. Lengths are not printed: a 0.6 m class arm is chosen."""

    a1_m: float = Field(default=0.075, ge=0.0, le=0.5, description="shoulder offset a1 [m]; choice")
    a2_m: float = Field(default=0.270, ge=0.05, le=1.0, description="upper arm a2 [m]; choice: reach of about 0.6 m")
    a3_m: float = Field(default=0.070, ge=0.0, le=0.5, description="elbow offset a3 [m]; choice")
    d4_m: float = Field(default=0.270, ge=0.05, le=1.0, description="forearm d4 [m]; choice")
    pedestal_m: float = Field(
        default=0.40, ge=0.05, le=2.0, description="floor to the shoulder, D-H frame 0 [m]; choice"
    )
    limit_deg: tuple[float, float, float, float, float, float] = Field(
        default=(170.0, 130.0, 170.0, 180.0, 125.0, 180.0),
        description="symmetric joint limits [deg]; choice, RB03 class",
    )
    zero_deg: tuple[float, float, float, float, float, float] = Field(
        default=(0.0, -60.0, 0.0, 0.0, 0.0, 0.0), description="middle of each joint's range [deg]; choice"
    )
    speed_deg_s: float = Field(
        default=120.0, ge=1.0, le=720.0, description="speed limit of every joint [deg/s]; choice"
    )
    grip_m: float = Field(
        default=0.20, ge=0.05, le=0.5, description="d of (4): last link to gripping point [m]; choice"
    )
    finger_length_m: float = Field(
        default=0.100, ge=0.02, le=0.3, description="effective finger length [m]; source 5.2"
    )
    finger_height_m: float = Field(default=0.020, ge=0.005, le=0.1, description="finger height [m]; source 5.2")
    finger_thickness_m: float = Field(default=0.006, ge=0.001, le=0.03, description="finger thickness [m]; choice")
    opening_m: float = Field(
        default=0.090, ge=0.02, le=0.2, description="widest opening between the fingers [m]; source 5.2"
    )
    blade_length_m: float = Field(default=0.115, ge=0.02, le=0.3, description="blade length [m]; source 5.2")
    blade_opening_deg: float = Field(
        default=75.0, ge=10.0, le=120.0, description="widest angle between blades [deg]; source"
    )
    blade_above_m: float = Field(
        default=0.018, ge=0.005, le=0.1, description="blade plane above the finger centre [m]; choice"
    )
    tray_axis_m: float = Field(default=0.180, ge=0.05, le=0.4, description="tray axis to finger centre [m]; source 5.2")
    tray_below_m: float = Field(default=0.150, ge=0.0, le=0.4, description="part of it that is downward [m]; choice")
    net_diameter_m: float = Field(default=0.120, ge=0.03, le=0.3, description="tray net diameter [m]; source 5.2")
    net_centre_m: float = Field(default=0.110, ge=0.03, le=0.3, description="tray axis to net centre [m]; choice")
    tray_deg: float = Field(default=90.0, ge=30.0, le=120.0, description="largest tray angle [deg]; source 5.2")


class PlantletArmConfig(RobotSection):
    """Five-joint transplanting arm and gripper. Lengths are not printed: they reach all way points."""

    d1_m: float = Field(default=0.0, ge=-1.0, le=1.0, description="reference frame to shoulder height [m]; choice")
    a1_m: float = Field(default=0.0, ge=0.0, le=0.5, description="shoulder offset [m]; choice")
    a2_m: float = Field(default=0.220, ge=0.05, le=1.0, description="upper arm [m]; choice")
    a3_m: float = Field(default=0.200, ge=0.05, le=1.0, description="forearm [m]; choice")
    d5_m: float = Field(default=0.0, ge=0.0, le=0.5, description="pitch axis to wrist frame [m]; choice")
    tool_m: float = Field(default=0.130, ge=0.02, le=0.4, description="wrist frame to gripping point [m]; choice")
    limit_deg: tuple[float, float, float, float, float] = Field(
        default=(170.0, 170.0, 160.0, 160.0, 180.0), description="symmetric joint limits [deg]; choice"
    )
    speed_deg_s: float = Field(
        default=120.0, ge=1.0, le=720.0, description="speed limit of every joint [deg/s]; choice"
    )
    jaw_width_m: float = Field(default=0.008, ge=0.002, le=0.03, description="width of the closed jaws [m]; choice")
    jaw_depth_m: float = Field(default=0.006, ge=0.002, le=0.03, description="depth of the jaws [m]; choice")
    shank_radius_m: float = Field(
        default=0.009, ge=0.002, le=0.03, description="radius of the gripper's shank [m]; choice"
    )


class TomatoArmConfig(RobotSection):
    """Cherry-tomato arm; all lengths are the source's."""

    d2_m: float = Field(default=0.60, ge=0.0, le=2.0, description="base height d2 [m]; source, step (1)")
    a3_m: float = Field(default=0.55, ge=0.05, le=2.0, description="upper arm a3 [m]; source, step (1)")
    a4_m: float = Field(default=0.12, ge=0.0, le=2.0, description="elbow link a4 [m]; source, step (1)")
    d5_m: float = Field(default=0.50, ge=0.0, le=2.0, description="forearm d5 [m]; source, step (1)")
    a6_m: float = Field(default=0.16, ge=0.0, le=2.0, description="end effector a6 [m]; source, step (1)")
    limit_deg: tuple[float, float, float, float, float] = Field(
        default=(180.0, 170.0, 170.0, 180.0, 170.0), description="symmetric joint limits [deg]; source, step (2)"
    )
    speed_deg_s: float = Field(
        default=200.0, ge=1.0, le=720.0, description="speed limit of every joint [deg/s]; choice"
    )
