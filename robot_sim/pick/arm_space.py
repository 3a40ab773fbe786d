"""Whether postures of the right and left arm are free: of each other, the trunk, the workspace's ends and the plants.

Postures are (6,): C1, C2, elbow of the right and of the left arm [rad]; the rear arm stays where it is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robot_sim.arm_links import link_poses
from robot_sim.capsules import arm_model
from robot_sim.clearance import least_margins_m, margins_m
from robot_sim.commands import ArmTarget
from robot_sim.config import RobotConfig
from robot_sim.derived import derived
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.planner import Scene
from robot_sim.urdf_parts_tools import GRIP_M

SPACING_M = 0.03
"""Spheres that stand for a capsule are no further apart."""
ROUNDING_M = 1e-4
FAR_M = 0.05
"""Plants further from the arms than this are as good as any further still."""


@dataclass(frozen=True, slots=True, eq=False)
class _Spheres:
    """The right and left arm as spheres: link 0..5 (N,), middle (N, 3) in the link's axes, radius (N,)."""

    link: np.ndarray
    middle_m: FloatArray
    radius_m: FloatArray


@derived
def _spheres(config: RobotConfig) -> _Spheres:
    m = arm_model(config)
    link, middle, radius = [], [], []
    for body, (a, b), r in zip(m.body, m.ends_m, m.radius_m, strict=True):
        if not 0 <= body < 6:
            continue
        count = max(2, int(np.linalg.norm(b - a) / SPACING_M) + 2)
        for s in np.linspace(0.0, 1.0, count):
            link.append(int(body))
            middle.append(a + s * (b - a))
            radius.append(r)
    return _Spheres(np.array(link), np.array(middle), np.array(radius))


@dataclass(frozen=True, slots=True, eq=False)
class Carried:
    """What hangs from the gripper, as balls straight under the grip point: how far below (N,), radius (N,) [m]."""

    below_m: FloatArray
    radius_m: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class ArmSpace:
    """Free postures of both working arms in one scene. q_rear (3,) [rad]. scene: in the disc's axes.

    spare_m: plants are kept away from by so much more than they must: where the robot will stand is not known better.
    Margins that the start breaks already need only not get smaller: nobody gets stuck.
    """

    config: RobotConfig
    scene: Scene
    q_rear: FloatArray
    start: FloatArray
    spare_m: float = 0.0

    def links(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Rotations (9, 3, 3) and origins (9, 3) of the links at a posture (6,), in the disc's axes."""
        return link_poses(self._all(q), self.config)

    def point(self, q: FloatArray, link: int, local_m: FloatArray) -> FloatArray:
        """A point (3,) of a link's axes in the disc's."""
        R, p = self.links(q)
        return np.asarray(p[link] + R[link] @ local_m)

    def gaps(self, q: FloatArray, carried: Carried | None = None) -> FloatArray:
        """What is left of every gap (10,) at a posture: arms, trunk, workspace (as PAIRS), then the plants; free if
        none is negative."""
        pick = self.config.pick
        need = least_margins_m(self.config) + np.array([pick.arm_gap_m] * 3 + [0.002] * 3 + [0.0] * 3)
        own = margins_m(self._all(q), self.config) - need
        plants = self.scene.gap(*self._points(q, carried), far_m=FAR_M) - pick.plant_gap_m - self.spare_m
        if carried is not None:
            own[0] = min(own[0], self._over_box(q, carried))
        return np.append(own, plants)

    def check(self, carried: Carried | None = None) -> Callable[[FloatArray], bool]:
        """The question whether both arms may be at a posture (6,)."""
        least = np.minimum(0.0, self.gaps(self.start, carried) - ROUNDING_M)
        return lambda q: bool((self.gaps(q, carried) >= least).all())

    def along(self, path: FloatArray, carried: Carried | None = None) -> bool:
        """Whether all postures of a path (M, 6) are free."""
        free = self.check(carried)
        return all(free(q) for q in path)

    def _all(self, q: FloatArray) -> FloatArray:
        return np.concatenate([q, self.q_rear])

    def _points(self, q: FloatArray, carried: Carried | None) -> tuple[FloatArray, FloatArray]:
        s = _spheres(self.config)
        R, p = self.links(q)
        points = p[s.link] + np.einsum("nij,nj->ni", R[s.link], s.middle_m)
        if carried is None:
            return points, s.radius_m
        hanging = self._hanging(q, carried)
        return np.concatenate([points, hanging]), np.concatenate([s.radius_m, carried.radius_m])

    def _hanging(self, q: FloatArray, carried: Carried) -> FloatArray:
        grip = self.point(q, 2, np.array([0.0, 0.0, -self.config.arm.forearm_m - GRIP_M]))
        return np.asarray(grip - np.outer(carried.below_m, (0.0, 0.0, 1.0)))

    def _over_box(self, q: FloatArray, carried: Carried) -> float:
        """Gap between what the gripper carries and the left forearm with its box [m]."""
        s = _spheres(self.config)
        R, p = self.links(q)
        left = s.link == 5
        box = p[5] + s.middle_m[left] @ R[5].T
        between = np.linalg.norm(self._hanging(q, carried)[:, None] - box[None], axis=2)
        return float((between - carried.radius_m[:, None] - s.radius_m[left]).min()) - self.config.pick.plant_gap_m


def posture(right: ArmTarget, left: ArmTarget) -> FloatArray:
    """(6,) of two arms' servo angles."""
    return np.radians([
        right.c1_deg, right.c2_deg, 180.0 - right.elbow_deg, left.c1_deg, left.c2_deg, 180.0 - left.elbow_deg
    ])  # fmt: skip


def targets_of(q: FloatArray) -> tuple[ArmTarget, ArmTarget]:
    """The servo angles of the right and left arm at a posture (6,)."""
    d = np.degrees(q).tolist()
    return ArmTarget(d[0], d[1], 180.0 - d[2]), ArmTarget(d[3], d[4], 180.0 - d[5])
