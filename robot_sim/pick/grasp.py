"""How to stand and reach for one fruit: height of the lift, drive along the row, posture of the right arm."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from robot_sim.arm_links import link_poses
from robot_sim.config import RobotConfig
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.plants import PEDUNCLE_M, Fruit
from robot_sim.reach import angles_for_hands
from robot_sim.stance import Stance
from robot_sim.urdf_parts_chassis import DISC_HEIGHT_M
from robot_sim.urdf_parts_tools import CUT_HALF_M, CUT_MIDDLE_M, GRIP_M

LIFT_STEP_M, DRIVE_STEP_M = 0.01, 0.02
CUT_SPARE_M = 0.008
"""The peduncle counts as between the blades this far from their ends: a gripped fruit shifts a little."""
LEVEL_RAD, TURNED_DEG, LIFTED_M, DRIVEN_M = 0.12, 15.0, 0.06, 0.1
"""A forearm that much out of level, a C2 that much turned, a lift or chassis that far moved: equally unwelcome."""


@dataclass(frozen=True, slots=True)
class Demands:
    """What a grasp must spare: how far inside the joints' ranges [rad], how much of the peduncle between the blades
    [m]; and how much more than configured the forearm may tilt [rad]."""

    inside_rad: float
    peduncle_m: float
    tilt_rad: float


AHEAD = Demands(0.05, 0.02, 0.0)
ON_THE_SPOT = Demands(0.02, 0.01, 0.06)
"""Where a robot came to stand some millimetres off a place that met the demands from afar."""


@dataclass(frozen=True, slots=True, eq=False)
class Grasp:
    """Where to stand, and the right arm with its pads round the fruit.

    drive_m: straight on from where the robot stands now. q_right (3,): C1, C2, elbow [rad]. approach (3,): level
    direction in which the hand comes, in the disc's axes.
    """

    stance: Stance
    drive_m: float
    q_right: FloatArray
    approach: FloatArray


def grip_point_m(fruit: Fruit, at_m: Sequence[float], config: RobotConfig) -> FloatArray:
    """Where the pads close on a fruit whose middle is at ``at_m`` (3,), world [m]."""
    return np.asarray(at_m) + np.array([0.0, 0.0, fruit.top_m - config.pick.grip_under_top_m])


def grasps_here(stance: Stance, grip_m: FloatArray, config: RobotConfig) -> Iterator[Grasp]:
    """The grasp of a fruit with chassis and lift where they are, if there is one. grip_m: (3,) in the world."""
    yield from _grasps(stance, grip_m, np.zeros(1), np.array([stance.lift_m]), ON_THE_SPOT, config)


def grasps(stance: Stance, grip_m: FloatArray, most_m: float, config: RobotConfig) -> Iterator[Grasp]:
    """Grasps of a fruit, best first; at first those that need no drive, then those after a drive of ``most_m`` at most.

    The forearm should be level, because the cutter is above the gripper; C2, lift and chassis should move little.
    """
    lift = config.body.lift
    # the lift's own height is among those tried, so that a good posture needs no lift at all
    heights = np.append(np.arange(lift.lower, lift.upper + 1e-9, LIFT_STEP_M), stance.lift_m)
    yield from _grasps(stance, grip_m, np.zeros(1), heights, AHEAD, config)
    steps = DRIVE_STEP_M * np.arange(1, int(most_m / DRIVE_STEP_M + 1e-9) + 1)
    if len(steps):
        yield from _grasps(stance, grip_m, np.concatenate([-steps, steps]), heights, AHEAD, config)


def _grasps(
    stance: Stance,
    grip_m: FloatArray,
    drives_m: FloatArray,
    heights_m: FloatArray,
    demands: Demands,
    config: RobotConfig,
) -> Iterator[Grasp]:
    """Those at all combinations of drive and height of the lift, best first."""
    # driving and lifting shift the fruit in the disc's axes
    ahead = stance.to_disc(grip_m, config) - stance.driven(1.0).to_disc(grip_m, config)
    drive, height = (v.ravel() for v in np.meshgrid(drives_m, heights_m, indexing="ij"))
    points = stance.to_disc(grip_m, config) - np.outer(drive, ahead)
    points[:, 2] -= height - stance.lift_m
    q = angles_for_hands("right", points - np.array([0.0, 0.0, DISC_HEIGHT_M]), GRIP_M, config)
    tilt = np.arcsin(np.clip(_forearm_up(q), -1.0, 1.0))
    cost = (tilt / LEVEL_RAD) ** 2 + (np.degrees(q[:, 1]) / TURNED_DEG) ** 2
    cost += np.abs(height - stance.lift_m) / LIFTED_M + np.abs(drive) / DRIVEN_M
    usable = _in_range(q, demands.inside_rad, config) & (np.abs(tilt) <= config.pick.tilt_rad + demands.tilt_rad)
    for i in np.flatnonzero(usable)[np.argsort(cost[usable], kind="stable")]:
        approach, cuts = _tool(q[i], points[i], config)
        if cuts >= demands.peduncle_m:
            there = replace(stance.driven(float(drive[i])), lift_m=float(height[i]))
            yield Grasp(there, float(drive[i]), q[i], approach)


def _forearm_up(q: FloatArray) -> FloatArray:
    """Upward part of the forearm's direction for angles (N, 3); as robot_sim.arm_angles.forearm_direction."""
    c1, c2, bend = q.T
    return np.asarray(np.sin(c1) * np.sin(bend) - np.cos(c1) * np.cos(c2) * np.cos(bend))


def _in_range(q: FloatArray, inside_rad: float, config: RobotConfig) -> npt.NDArray[np.bool_]:
    """Which angles (N, 3) lie so far inside the joints' ranges."""
    limits = (config.arm.c1, config.arm.c2, config.arm.elbow)
    lower, upper = (np.array([getattr(a, end) for a in limits]) for end in ("lower", "upper"))
    return np.asarray(((q >= lower + inside_rad) & (q <= upper - inside_rad)).all(axis=1))


def _tool(q_right: FloatArray, grip_m: FloatArray, config: RobotConfig) -> tuple[FloatArray, float]:
    """The level direction of the forearm (3,), and how much of an upright peduncle is between the blades [m]."""
    q = np.zeros(9)
    q[:3] = q_right
    R, p = link_poses(q, config)
    ahead = -R[2][:, 2].copy()
    ahead[2] = 0.0
    steps = np.linspace(0.0, PEDUNCLE_M, 33)
    points = grip_m + np.outer(config.pick.grip_under_top_m + steps, (0.0, 0.0, 1.0))
    local = (points - p[2]) @ R[2] + np.array([0.0, 0.0, config.arm.forearm_m])
    between = (np.abs(local - CUT_MIDDLE_M) <= np.array(CUT_HALF_M) - CUT_SPARE_M).all(axis=1)
    return ahead / np.linalg.norm(ahead), float(between.sum()) * PEDUNCLE_M / (len(steps) - 1)
