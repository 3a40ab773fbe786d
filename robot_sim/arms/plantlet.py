"""The plantlet-transplanting arm (yaw, three pitches, roll) with a slim gripper that points down at zero pitch."""

from __future__ import annotations

import numpy as np

from robot_sim.arms.config import PlantletArmConfig
from robot_sim.arms.urdf_writer import ArmModel, ToolLink, limbs_of
from robot_sim.kinematics import Joint, PitchArm
from robot_sim.kinematics.transforms import translation
from robot_sim.planner.shapes import Cylinder, box, upright_cylinder


def plantlet_arm(config: PlantletArmConfig | None = None) -> PitchArm:
    """The arm; its tool frame is the gripping point, z along the approach."""
    c = config or PlantletArmConfig()
    joints = [
        Joint(f"joint{i}", lower=-np.radians(limit), upper=np.radians(limit), speed=np.radians(c.speed_deg_s))
        for i, limit in enumerate(c.limit_deg, start=1)
    ]
    lengths = (c.d1_m, c.a1_m, c.a2_m, c.a3_m, c.d5_m)
    return PitchArm.from_lengths("plantlet_arm", lengths, joints, translation(0.0, 0.0, c.tool_m))


def gripper_solids(config: PlantletArmConfig | None = None) -> tuple[Cylinder, ...]:
    """What goes into the bottle, in the tool frame: the shank behind the jaws, the jaws as their round hull."""
    c = config or PlantletArmConfig()
    jaws = 0.04
    hull = float(np.hypot(c.jaw_width_m, c.jaw_depth_m)) / 2
    shank = c.tool_m - jaws
    return (
        upright_cylinder((0.0, 0.0, -jaws / 2), hull, jaws),
        upright_cylinder((0.0, 0.0, -jaws - shank / 2), c.shank_radius_m, shank),
    )


def plantlet_model(arm: PitchArm, config: PlantletArmConfig | None = None) -> ArmModel:
    """Links as limbs on a pedestal; the gripper as jaws and shank."""
    c = config or PlantletArmConfig()
    solids = limbs_of(arm.chain, 0.022)
    solids.setdefault(-1, []).append(upright_cylinder((0.0, 0.0, -0.13), 0.05, 0.22))
    shank = gripper_solids(c)[1]
    jaws = box((0.0, 0.0, -0.02), (c.jaw_width_m, c.jaw_depth_m, 0.04))
    tool = ToolLink("gripper", "tool0", np.eye(4), (jaws, shank))
    return ArmModel(arm.chain, solids, (tool,))
