"""One pick as a motion in time: smooth through the key points, straight to the peduncle, tool joints in step."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robot_sim.arms.config import GrapeArmConfig
from robot_sim.arms.rb03 import tool_values
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.studies.config import GrapeStudyConfig
from robot_sim.studies.grape_plan import PickPlan
from robot_sim.trajectories import Trajectory

STEP_S = 0.02
CLOSE_S, HOLD_S, CUT_S = 0.8, 1.0, 0.5


@dataclass(frozen=True, slots=True, eq=False)
class PickMotion:
    """Samples of a whole pick: t_s (M,), q (M, 6), tool joints (M, 5)."""

    t_s: FloatArray
    q: FloatArray
    tool: FloatArray


def pick_motion(config: GrapeArmConfig, study: GrapeStudyConfig, plan: PickPlan, tray_deg: float) -> PickMotion:
    """Start -> ready -> picking point, clamp, hold, cut, back, -> basket, release."""
    a = plan.approach
    grip, tray = 2 * study.stem_radius_m, math.radians(tray_deg)
    opened, clamped = a.tool(), tool_values(grip, 0.0, a.blade_rad)
    carried, cut = tool_values(grip, tray, a.blade_rad), tool_values(grip, tray, 0.0)
    released = tool_values(config.opening_m, 0.0, 0.0)
    legs: list[tuple[Trajectory | None, FloatArray, FloatArray, float]] = [
        (plan.legs.out, opened, opened, 0.0),
        (plan.legs.pick, opened, opened, 0.0),
        (None, opened, clamped, CLOSE_S),
        (None, clamped, carried, HOLD_S),
        (None, carried, cut, CUT_S),
        (plan.legs.back, cut, cut, 0.0),
        (plan.legs.basket, cut, cut, 0.0),
        (None, cut, released, HOLD_S),
    ]
    t_all, q_all, tool_all = [], [], []
    now, q_now = 0.0, plan.out_q[0]
    for trajectory, tool_from, tool_to, rest_s in legs:
        length = trajectory.duration_s if trajectory is not None else rest_s
        t = np.arange(0.0, length - 1e-6, STEP_S)  # the next leg begins where this one ends
        if trajectory is None:
            q = np.repeat(q_now[None], len(t), axis=0)
        else:
            q = trajectory.at(t).q
            q_now = trajectory.at(length).q[0]
        t_all.append(now + t)
        q_all.append(q)
        tool_all.append(tool_from + (t / length)[:, None] * (tool_to - tool_from))
        now += length
    return PickMotion(np.concatenate(t_all), np.concatenate(q_all), np.concatenate(tool_all))
