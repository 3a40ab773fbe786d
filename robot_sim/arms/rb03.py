"""The grape arm: GSK RB03 with the clamp-hold-cut end effector (the grape source's figures 3 to 6).

Tool frame: origin at the gripping point between the fingers (eq. (4)), z along the approach, x from finger to finger,
y completes it. In a level pick y points down: the fingers are high along y, the tray hangs at +y, the blades at -y.
"""

from __future__ import annotations

import math

import numpy as np

from robot_sim.arms.config import GrapeArmConfig
from robot_sim.arms.urdf_writer import ORANGE, STEEL, ArmModel, ToolLink, limbs_of
from robot_sim.kinematics import Joint, SphericalWristArm
from robot_sim.kinematics.transforms import FloatArray, rot_x, rot_y, rot_z, translation
from robot_sim.planner.shapes import Cylinder, box, upright_cylinder

TOOL_JOINTS = ("finger_left_joint", "finger_right_joint", "tray_joint", "blade_left_joint", "blade_right_joint")


def grape_arm(config: GrapeArmConfig | None = None) -> SphericalWristArm:
    """The arm; frame 0 lies at the shoulder, the tool frame at the gripping point."""
    c = config or GrapeArmConfig()
    joints = [
        Joint(
            f"joint{i}",
            lower=math.radians(zero - limit),
            upper=math.radians(zero + limit),
            speed=math.radians(c.speed_deg_s),
        )
        for i, (zero, limit) in enumerate(zip(c.zero_deg, c.limit_deg, strict=True), start=1)
    ]
    lengths = (c.a1_m, c.a2_m, c.a3_m, c.d4_m)
    # a quarter turn at the flange, so that a level pick has the wrist near the middle of its range
    tool = rot_z(math.pi / 2) @ translation(0.0, 0.0, c.grip_m)
    return SphericalWristArm.from_lengths("gsk_rb03", lengths, joints, tool)


def tool_values(opening_m: float, tray_rad: float, blade_rad: float) -> FloatArray:
    """Joint values (5,) of TOOL_JOINTS for an opening between the fingers, a tray angle, an angle between blades."""
    return np.array([opening_m / 2, opening_m / 2, tray_rad, blade_rad / 2, blade_rad / 2])


def _fingers(c: GrapeArmConfig) -> list[ToolLink]:
    tools = []
    for name, side in (("finger_left", 1.0), ("finger_right", -1.0)):
        # the joint's z runs outward along +-x; at zero the finger's inner face is on the tool axis
        T = rot_y(side * math.pi / 2)
        size = (c.finger_length_m, c.finger_height_m, c.finger_thickness_m)
        solid = box((0.0, 0.0, c.finger_thickness_m / 2), size)
        tools.append(ToolLink(name, "tool0", T, (solid,), "prismatic", 0.0, c.opening_m / 2, 0.2, STEEL))
    return tools


def _blades(c: GrapeArmConfig) -> list[ToolLink]:
    tools = []
    back = c.blade_length_m - c.finger_length_m / 2
    for name, side in (("blade_left", 1.0), ("blade_right", -1.0)):
        # the joint's z is the tool's -+y, so that a positive angle opens towards +-x
        T = translation(0.0, -c.blade_above_m, -back) @ rot_x(side * -math.pi / 2)
        along = -side  # where the tool's z lies in the joint frame, along y
        solid = box((side * 0.006, along * c.blade_length_m / 2, 0.0), (0.012, c.blade_length_m, 0.002))
        upper = math.radians(c.blade_opening_deg) / 2
        tools.append(ToolLink(name, "tool0", T, (solid,), "revolute", 0.0, upper, 3.0, ORANGE))
    return tools


def tray_axis(c: GrapeArmConfig) -> FloatArray:
    """Point (3,) of the tray's axis in the tool frame."""
    behind = math.sqrt(max(0.0, c.tray_axis_m**2 - c.tray_below_m**2))
    return np.array([0.0, c.tray_below_m, -behind])


def _tray(c: GrapeArmConfig) -> ToolLink:
    # joint z = tool x; at zero the net hangs along tool y (down), a positive angle swings it to tool z (forward)
    x, y, z = tray_axis(c)
    R = np.eye(4)
    R[:3, :3] = np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])  # columns: joint x -> tool y, joint y -> tool z
    net = Cylinder(translation(c.net_centre_m, 0, 0) @ rot_y(0.0) @ rot_x(math.pi / 2), c.net_diameter_m / 2, 0.004)
    stem = box((c.net_centre_m / 4, 0, 0), (c.net_centre_m / 2, 0.004, 0.02))
    upper = math.radians(c.tray_deg)
    return ToolLink("tray", "tool0", translation(x, y, z) @ R, (net, stem), "revolute", 0.0, upper, 2.0, STEEL)


def grape_model(arm: SphericalWristArm, config: GrapeArmConfig | None = None) -> ArmModel:
    """Links as limbs on a pedestal, palm with tray bracket, two fingers, two blades, tray."""
    c = config or GrapeArmConfig()
    solids = limbs_of(arm.chain, 0.035)
    solids.setdefault(-1, []).append(upright_cylinder((0, 0, -c.pedestal_m / 2 - 0.04), 0.07, c.pedestal_m - 0.08))
    palm_front = -c.finger_length_m / 2
    palm_depth = 0.03
    x, y, z = tray_axis(c)
    rear = -c.grip_m
    palm = box((0, 0, palm_front - palm_depth / 2 - 0.02), (c.opening_m + 0.012, c.finger_height_m, palm_depth))
    wrist = box((0, 0, (rear + palm_front) / 2 - 0.02), (0.05, 0.04, palm_front - rear - 0.04))
    bracket = box((x, y / 2, z - 0.012), (0.03, y, 0.008))
    tools = (
        ToolLink("palm", "tool0", np.eye(4), (palm, wrist, bracket)),
        *_fingers(c),
        _tray(c),
        *_blades(c),
    )
    return ArmModel(arm.chain, solids, tools)
