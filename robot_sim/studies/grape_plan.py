"""Plans one pick: which bunch, from where, how high on the peduncle, and the way there, back and to the basket."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from robot_sim.arms.config import GrapeArmConfig
from robot_sim.arms.rb03 import tool_values, tray_axis
from robot_sim.kinematics import SphericalWristArm
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.planner import FieldConfig, PathReason, Scene, Solid, key_points, plan_path
from robot_sim.studies.config import GrapeStudyConfig
from robot_sim.studies.grape_legs import Legs, smooth_leg
from robot_sim.studies.grape_scene import Bunch, GrapeScene
from robot_sim.trajectories import DriveLine, follow_line

AWAY_M = 0.03
"""What a way out straight away from the neighbour is worth, in clearance."""
YAWS_DEG = (0.0, 20.0, -20.0, 40.0, -40.0, 60.0, -60.0, 80.0, -80.0)


@dataclass(frozen=True, slots=True, eq=False)
class Approach:
    """One way to grip: bunch index, tool yaw, height over the bunch's top, openings; clearance seen at the end, m."""

    bunch: int
    yaw_rad: float
    height_m: float
    opening_m: float
    blade_rad: float
    clearance_m: float

    def tool(self, tray_rad: float = 0.0) -> FloatArray:
        """Tool joint values (5,) with fingers and blades open."""
        return tool_values(self.opening_m, tray_rad, self.blade_rad)


@dataclass(frozen=True, slots=True, eq=False)
class PickPlan:
    """Joint key points of the legs: out (start -> ready), pick (ready -> picking point), basket (ready -> basket).

    key_points_m: all key points of the tool on the whole pick (K, 3), the way back included. legs: the motions.
    """

    approach: Approach
    out_q: FloatArray
    pick_q: FloatArray
    basket_q: FloatArray
    key_points_m: FloatArray
    minima: int
    legs: Legs


def level_pose(p_m: FloatArray, yaw_rad: float) -> FloatArray:
    """Tool pose at p (3,): approach level at the yaw, the tool's y down."""
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    T = np.eye(4)
    T[:3, 0], T[:3, 1], T[:3, 2], T[:3, 3] = (s, -c, 0), (0, 0, -1), (c, s, 0), p_m
    return T


def tool_body(c: GrapeArmConfig, opening_m: float, blade_rad: float) -> tuple[FloatArray, FloatArray]:
    """Control spheres of the end effector in the tool frame: centres (C, 3) and radii (C,)."""
    half, mid = c.finger_length_m / 2, opening_m / 2 + c.finger_thickness_m / 2
    spheres: list[tuple[float, float, float, float]] = []
    for side in (-1.0, 1.0):
        spheres += [(side * mid, 0.0, z, c.finger_height_m / 2) for z in np.linspace(-half, half, 5)]
        reach, a = c.blade_length_m, blade_rad / 2
        back = c.blade_length_m - half
        for share in (0.5, 0.75, 1.0):
            across = side * (share * reach * math.sin(a) + 0.012 * math.cos(a))
            spheres.append((across, -c.blade_above_m, share * reach * math.cos(a) - back, 0.004))
        spheres.append((side * (c.opening_m / 2 - 0.01), 0.0, -half - 0.035, 0.018))
    spheres += [(0.0, 0.0, -half - 0.05, 0.025), (0.0, 0.0, -half - 0.1, 0.03)]
    x, y, z = tray_axis(c)
    spheres += [(x, share * y, z - 0.012, 0.016) for share in (0.3, 0.6, 0.9)]
    net = c.net_diameter_m / 2
    spheres += [(x + dx, y + c.net_centre_m + dy, z, 0.006) for dx in (-net, 0, net) for dy in (-net, 0, net)]
    array = np.array(spheres)
    return array[:, :3], array[:, 3]


def window(bunch: Bunch, arm: GrapeArmConfig) -> tuple[float, float]:
    """Lowest and highest height of the finger centre over the bunch's top: finger above berries, blade below cane."""
    return arm.finger_height_m / 2, bunch.peduncle_m - arm.blade_above_m - 0.002


def approaches(
    seen: GrapeScene, arm: GrapeArmConfig, study: GrapeStudyConfig, height_m: float | None = None
) -> list[Approach]:
    """All ways to grip in falling clearance; height_m fixes the height over the top, else the window's middle is used.

    The clearance counts neighbours, cane and post against the whole tool, and the bunch itself against fingers and
    blades by H1.
    """
    found = []
    for k, bunch in enumerate(seen.bunches):
        low, high = window(bunch, arm)
        height = max(0.5 * (low + high), low + study.margin_h1_m) if height_m is None else height_m
        others: tuple[Solid, ...] = tuple(b.volume for i, b in enumerate(seen.bunches) if i != k)
        scene = Scene((*others, *seen.obstacles, bunch.volume))
        grip = bunch.top_m + np.array([0.0, 0.0, height])
        bearing = math.atan2(bunch.top_m[1], bunch.top_m[0])
        for opening, blade_deg in ((arm.opening_m, arm.blade_opening_deg), (0.064, 50.0), (0.046, 36.0)):
            offsets, radii = tool_body(arm, opening, math.radians(blade_deg))
            for yaw_deg in YAWS_DEG:
                yaw = bearing + math.radians(yaw_deg)
                T = level_pose(grip, yaw)
                world = offsets @ T[:3, :3].T
                way = grip - np.linspace(0, study.back_off_m, 6)[:, None] * T[:3, 2]
                clearance = float(scene.clearance(way, world, radii).min())
                # a wide opening forgives the camera's error across, the yaw costs reach: both only break ties
                worth = clearance + 0.05 * (opening - arm.opening_m) - 2e-5 * abs(yaw_deg)
                worth += AWAY_M * min(0.5, _away(bunch, others, T[:2, 2]))
                found.append((worth, Approach(k, yaw, height, opening, math.radians(blade_deg), clearance)))
    return [a for _, a in sorted(found, key=lambda f: -f[0])]


def _away(bunch: Bunch, others: tuple[Solid, ...], heading: FloatArray) -> float:
    """Cosine between the way back out, against the heading (2,), and the direction away from the nearest neighbour."""
    apart = [bunch.top_m[:2] - other.centre[:2] for other in others]
    if not apart:
        return 0.5
    nearest = min(apart, key=lambda v: float(v @ v))
    return -float(nearest @ heading) / max(1e-9, float(np.linalg.norm(nearest)))


def _nearest(arm: SphericalWristArm, T: FloatArray, q: FloatArray) -> FloatArray | None:
    return arm.inverse(T, q_ref=q).nearest(q)


def _joint_way(arm: SphericalWristArm, points: FloatArray, yaws: FloatArray, q: FloatArray) -> FloatArray | None:
    """Joint values (K, 6) of level poses along key points, each nearest to the last; None when one has no solution."""
    out: list[FloatArray] = []
    for p, yaw in zip(points, yaws, strict=True):
        nearest = _nearest(arm, level_pose(p, float(yaw)), q)
        if nearest is None or (out and np.abs(nearest - q).max() > 1.2):
            return None
        out.append(nearest)
        q = nearest
    return np.array(out)


def _turning(n: int, a: float, b: float) -> FloatArray:
    """Yaws (n,) from a to b that are done after two thirds of the way."""
    share = np.clip(np.linspace(0, 1, n) * 1.5, 0, 1)
    return a + share * (b - a)


def plan_pick(
    seen: GrapeScene,
    approach: Approach,
    arm: SphericalWristArm,
    arm_config: GrapeArmConfig,
    study: GrapeStudyConfig,
    field: FieldConfig,
    q_start: FloatArray,
) -> PickPlan | str:
    """The whole pick for one approach, or the reason (a code) why this approach does not work."""
    bunch = seen.bunches[approach.bunch]
    grip = bunch.top_m + np.array([0.0, 0.0, approach.height_m])
    T_grip = level_pose(grip, approach.yaw_rad)
    ready = grip - study.back_off_m * T_grip[:3, 2]
    offsets, radii = tool_body(arm_config, approach.opening_m, approach.blade_rad)
    world = offsets @ T_grip[:3, :3].T
    scene = Scene((*(b.volume for b in seen.bunches), *seen.obstacles))
    start = np.array(study.start_m)
    if _nearest(arm, level_pose(ready, approach.yaw_rad), q_start) is None or _nearest(arm, T_grip, q_start) is None:
        return "ik.ready"

    def leg(
        a: FloatArray, b: FloatArray, through: Scene, body: tuple[FloatArray, FloatArray] = (world, radii)
    ) -> tuple[FloatArray, int] | str:
        result = plan_path(a, b, through, *body, field)
        if not result.ok:
            return "path.no_room" if result.reason is PathReason.GOAL_BLOCKED else str(result.reason)
        points = key_points(result.points, through, *body, margin_m=field.margin_m, spacing_m=study.spacing_m)
        return points, result.minima

    pick = leg(ready, grip, scene)
    if isinstance(pick, str):
        return pick
    out = leg(start, ready, scene)
    if isinstance(out, str):
        return out
    out_q = _joint_way(arm, out[0], _turning(len(out[0]), math.radians(study.start_yaw_deg), approach.yaw_rad), q_start)
    if out_q is None:
        return "ik.out"
    pick_q = [out_q[-1]]
    for a, b in pairwise(pick[0]):
        line = DriveLine.between(level_pose(a, approach.yaw_rad), level_pose(b, approach.yaw_rad))
        followed = follow_line(arm, line, 1.0, 0.2, pick_q[-1])
        if followed.motion is None:
            return "ik.pick"
        pick_q += list(followed.motion.q[1:])
    rest, held = _without(scene, bunch), _carried_body(bunch, grip)
    laden = (np.concatenate([world, held[0]]), np.concatenate([radii, held[1]]))
    basket = leg(ready, np.array(study.basket_m), rest, laden)
    if isinstance(basket, str):  # too tight for the volume as the planner sees it; the check of the motion decides
        basket = leg(ready, np.array(study.basket_m), rest)
    if isinstance(basket, str):
        return basket
    basket_q = _joint_way(arm, basket[0], _turning(len(basket[0]), approach.yaw_rad, -math.pi / 2), out_q[-1])
    if basket_q is None:
        return "ik.basket"
    every = np.concatenate([out[0], pick[0][1:], pick[0][::-1][1:], basket[0][1:]])
    way_in, speed = np.array(pick_q), study.speed_m_s
    legs = Legs(
        smooth_leg(arm, out_q, speed),
        smooth_leg(arm, way_in, speed / 2),
        smooth_leg(arm, way_in[::-1], speed / 2),
        smooth_leg(arm, basket_q, speed),
    )
    return PickPlan(approach, out_q, way_in, basket_q, every, out[1] + pick[1] + basket[1], legs)


def _without(scene: Scene, bunch: Bunch) -> Scene:
    gone = bunch.volume
    return Scene(tuple(s for s in scene.solids if not np.allclose(s.centre, gone.centre)))


def _carried_body(bunch: Bunch, grip_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The bunch under the fingers as spheres: centres (C, 3) from the gripping point in world axes, radii (C,)."""
    v = bunch.volume
    half = max(0.0, v.height_m / 2 - v.radius_m)
    centres = np.array([v.centre + np.array([0.0, 0.0, z]) for z in np.linspace(-half, half, 4)])
    return centres - grip_m, np.full(4, v.radius_m)
