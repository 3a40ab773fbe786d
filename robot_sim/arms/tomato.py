"""The cherry-tomato arm (five joints, the first two on one axis)."""

from __future__ import annotations

import numpy as np

from robot_sim.arms.config import TomatoArmConfig
from robot_sim.arms.urdf_writer import ORANGE, ArmModel, limb, limbs_of
from robot_sim.kinematics import Joint, TwinBaseArm
from robot_sim.planner.shapes import sphere


def tomato_arm(config: TomatoArmConfig | None = None) -> TwinBaseArm:
    """The arm with the source's limits; D-H table repaired (see ``TwinBaseArm``)."""
    c = config or TomatoArmConfig()
    joints = [
        Joint(f"joint{i}", lower=-np.radians(limit), upper=np.radians(limit), speed=np.radians(c.speed_deg_s))
        for i, limit in enumerate(c.limit_deg, start=1)
    ]
    return TwinBaseArm.from_lengths("cherry_tomato_arm", (c.d2_m, c.a3_m, c.a4_m, c.d5_m, c.a6_m), joints)


def tomato_model(arm: TwinBaseArm) -> ArmModel:
    """Links as limbs, the end effector as a thin limb with a ball at its tip."""
    chain = arm.chain
    solids = limbs_of(chain, 0.035)
    tip = chain.fixed[-1][:3, 3]
    solids.setdefault(chain.n - 1, []).extend([limb(np.zeros(3), tip, 0.015), sphere(tip, 0.02)])
    return ArmModel(chain, solids, color=ORANGE)
