"""Where a picked fruit is let go: postures in which the level box is under the gripper, drawn back from the crop."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from robot_sim.arm_links import link_poses
from robot_sim.config import RobotConfig
from robot_sim.derived import derived
from robot_sim.kinematics.transforms import FloatArray, rpy
from robot_sim.plants import Fruit
from robot_sim.reach import angles_for_hands
from robot_sim.urdf_parts_chassis import DISC_HEIGHT_M
from robot_sim.urdf_parts_tools import BOX_MIDDLE_M, BOX_PITCH_RAD, BOX_RPY, BOX_SIZE_M, GRIP_M

OVER_RIM_M = 0.025
"""The fruit passes over the box's rim with this to spare."""
OVER_FLOOR_M = 0.035
"""It is let go this far above the box's floor, or higher where the gripper would touch the rim."""
TILT_RAD = 0.27
AHEAD_M = 0.50
"""The box stays this near the mast: at the crop it would push against lower fruit."""
STEP_RAD = 0.07
SPARE_RAD = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class BoxPlace:
    """A posture of the left arm with its box level: q_left (3,) [rad], the box's middle (3,) in the disc's axes [m]."""

    q_left: FloatArray
    middle_m: FloatArray
    tilt_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class Release:
    """Both arms over the box and lowered into it: postures (6,) [rad]."""

    over: FloatArray
    lowered: FloatArray


@derived
def box_places(config: RobotConfig) -> tuple[BoxPlace, ...]:
    """Postures of the left arm with a level box before the chest, those nearest to the mast first."""
    limits = config.arm
    c1 = np.arange(limits.c1.lower + SPARE_RAD, 0.9, STEP_RAD)
    c2 = np.arange(max(limits.c2.lower + SPARE_RAD, -0.7), 0.45, STEP_RAD)
    off = np.radians([-10.0, -5.0, 0.0, 5.0, 10.0])
    q = np.stack([v.ravel() for v in np.meshgrid(c1, c2, off, indexing="ij")], axis=1)
    q[:, 2] += BOX_PITCH_RAD - q[:, 0]
    q = q[(q[:, 2] >= limits.elbow.lower) & (q[:, 2] <= limits.elbow.upper - SPARE_RAD)]
    all_arms = np.zeros((len(q), 9))
    all_arms[:, 3:6] = q
    R, p = link_poses(all_arms, config)
    centre = np.array(BOX_MIDDLE_M) - [0.0, 0.0, limits.forearm_m]
    middle = p[:, 5] + R[:, 5] @ centre
    tilt = np.arccos(np.clip((R[:, 5] @ rpy(*BOX_RPY)[:3, :3])[:, 2, 2], -1.0, 1.0))
    good = np.flatnonzero((tilt <= TILT_RAD) & (middle[:, 0] <= AHEAD_M))
    order = good[np.lexsort((tilt[good], middle[good, 0].round(2)))]
    return tuple(BoxPlace(q[i], middle[i], float(tilt[i])) for i in order)


def releases(under_grip_m: float, config: RobotConfig) -> Iterator[Release]:
    """Postures of both arms for a fruit that reaches ``under_grip_m`` below the grip point, nearest to the mast first.

    None of them is checked against anything but the right arm's reach.
    """
    places, half = box_places(config), 0.5 * BOX_SIZE_M[2]
    ups = (half + under_grip_m + OVER_RIM_M, max(under_grip_m + OVER_FLOOR_M - half, half + OVER_RIM_M))
    middles = np.array([place.middle_m for place in places]) - np.array([0.0, 0.0, DISC_HEIGHT_M])
    over, lowered = (angles_for_hands("right", middles + np.array([0.0, 0.0, up]), GRIP_M, config) for up in ups)
    arm = config.arm
    lower, upper = (np.array([getattr(a, end) for a in (arm.c1, arm.c2, arm.elbow)]) for end in ("lower", "upper"))
    for k in np.flatnonzero(((over >= lower) & (over <= upper) & (lowered >= lower) & (lowered <= upper)).all(axis=1)):
        yield Release(np.append(over[k], places[k].q_left), np.append(lowered[k], places[k].q_left))


def under_grip_m(fruit: Fruit, grip_under_top_m: float) -> float:
    """How far a fruit held ``grip_under_top_m`` under its top reaches below the grip [m]."""
    lowest = min(part.xyz_m[2] - fruit.xyz_m[2] - _half(part.kind, part.size_m) for part in fruit.parts)
    return fruit.top_m - grip_under_top_m - lowest


def _half(kind: str, size_m: tuple[float, ...]) -> float:
    return size_m[0] if kind == "sphere" else 0.5 * size_m[-1]
