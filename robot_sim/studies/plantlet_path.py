"""The transplanting cycle: way points, carrying moves (quintic), straight lines into and out of the bottles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robot_sim.errors import RobotError
from robot_sim.kinematics import PitchArm
from robot_sim.kinematics.transforms import FloatArray, rot_x, rot_y, rot_z, translation
from robot_sim.studies.bottle import Bottle
from robot_sim.studies.config import PlantletStudyConfig
from robot_sim.trajectories import DriveLine, Motion, follow_line, quintic


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """One move of the cycle: its name, kind (carry or line), ends by name, samples."""

    name: str
    kind: str
    motion: Motion


@dataclass(frozen=True, slots=True, eq=False)
class Cycle:
    """All legs in order, joint values at the named way points, the two bottles."""

    legs: tuple[Leg, ...]
    points: dict[str, FloatArray]
    bottles: tuple[Bottle, Bottle]

    def joined(self, pause_s: float, step_s: float) -> tuple[FloatArray, FloatArray]:
        """The whole cycle as times (M,) and joint values (M, n), with a rest after each leg."""
        t: list[FloatArray] = []
        q: list[FloatArray] = []
        now = 0.0
        for leg in self.legs:
            t.append(leg.motion.t_s + now)
            q.append(leg.motion.q)
            now += float(leg.motion.t_s[-1]) + pause_s
            t.append(np.array([now - step_s / 2]))
            q.append(leg.motion.q[-1:])
        return np.concatenate(t), np.concatenate(q)


def bottle_frame(wrist_m: tuple[float, float, float], tool_m: float) -> FloatArray:
    """T_base_B: the gripping point over the mouth, x straight down, z out of the page (the source's figure 2)."""
    x, y, z = wrist_m
    return translation(x, y, z - tool_m) @ rot_y(np.pi / 2)


def gripper_pose(T_base_B: FloatArray, turn_rad: float) -> FloatArray:
    """Tool pose at P1: the frame {B} turned by theta about its x; the tool's z is {B}'s x."""
    return T_base_B @ rot_x(turn_rad) @ rot_y(np.pi / 2) @ rot_z(np.pi)


def _solve(arm: PitchArm, T: FloatArray, q_ref: FloatArray, name: str) -> FloatArray:
    result = arm.inverse(T, q_ref=q_ref)
    nearest = result.nearest(q_ref)
    if nearest is None:
        raise RobotError(
            f"way point {name} cannot be reached ({result.reason}: {result.detail}); move it or the lengths"
        )
    return nearest


def _line(
    arm: PitchArm, T: FloatArray, shift: FloatArray, time_s: float, step_s: float, q: FloatArray, name: str
) -> Leg:
    result = follow_line(arm, DriveLine(T, shift, np.zeros(3)), time_s, step_s, q)
    if result.motion is None:
        raise RobotError(f"line {name} cannot be followed at {result.share:.0%}: {result.reason} {result.detail}")
    return Leg(name, "line", result.motion)


def _backwards(leg: Leg, name: str) -> Leg:
    m = leg.motion
    return Leg(name, "line", Motion(m.t_s, m.q[::-1], -m.qd[::-1], m.qdd[::-1]))


def plan_cycle(arm: PitchArm, study: PlantletStudyConfig) -> Cycle:
    """P0 -> P1 -> P2 -> A -> P2 -> P1 -> P3 -> P4 -> P5 -> planting point -> P5 -> P4 -> P1.

    Raises RobotError when a way point or a point on a line has no solution inside the joint limits.
    """
    tool = float(arm.T_last_tool[2, 3])
    turn = np.radians(study.turn_deg)
    B1, B4 = bottle_frame(study.wrist_p1_m, tool), bottle_frame(study.wrist_p4_m, tool)
    T1, T4 = gripper_pose(B1, turn), gripper_pose(B4, turn)
    T3 = gripper_pose(bottle_frame(study.wrist_p3_m, tool), 0.0)
    q0 = np.radians(study.start_deg)
    q1 = _solve(arm, T1, q0, "P1")
    q3 = _solve(arm, T3, q1, "P3")
    q4 = _solve(arm, T4, q3, "P4")

    def carry(name: str, a: FloatArray, b: FloatArray) -> Leg:
        return Leg(name, "carry", quintic(a, b, study.carry_s).sample(study.step_s))

    def into(T: FloatArray, q: FloatArray, names: tuple[str, str, str]) -> list[Leg]:
        top, deep, end = names
        down = _line(arm, T, np.array([0, 0, study.depth_m]), study.line_s, study.step_s, q, f"{top}-{deep}")
        T_deep = T @ translation(0, 0, study.depth_m)
        sideways = np.array([study.plantlet_m, 0.0, 0.0])
        reach = _line(arm, T_deep, sideways, study.reach_s, study.step_s, down.motion.q[-1], f"{deep}-{end}")
        return [down, reach, _backwards(reach, f"{end}-{deep}"), _backwards(down, f"{deep}-{top}")]

    take = into(T1, q1, ("P1", "P2", "A"))
    plant = into(T4, q4, ("P4", "P5", "plant"))
    legs = (
        carry("P0-P1", q0, q1),
        *take,
        carry("P1-P3", q1, q3),
        carry("P3-P4", q3, q4),
        *plant,
        carry("P4-P1", q4, q1),
    )
    mouth = np.array([0.0, 0.0, study.above_mouth_m])
    bottles = (Bottle(B1[:3, 3] - mouth, study.bottle), Bottle(B4[:3, 3] - mouth, study.bottle))
    points = {"P0": q0, "P1": q1, "P2": take[0].motion.q[-1], "A": take[1].motion.q[-1], "P3": q3, "P4": q4}
    return Cycle(legs, points | {"P5": plant[0].motion.q[-1]}, bottles)
