"""Carries out one planned pick against the true bunches: contacts, clamp, hold, cut, delivery."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from robot_sim.arms.config import GrapeArmConfig
from robot_sim.arms.rb03 import TOOL_JOINTS, tool_values
from robot_sim.collision import CollisionWorld, Contact
from robot_sim.kinematics import SphericalWristArm
from robot_sim.kinematics.transforms import FloatArray, inverse_pose
from robot_sim.planner import FieldConfig
from robot_sim.planner.key_points import path_length
from robot_sim.studies.config import GrapeStudyConfig
from robot_sim.studies.grape_carry import carried_hit, carried_volume_hit
from robot_sim.studies.grape_legs import Legs, free_leg, swept_rows
from robot_sim.studies.grape_plan import Approach, PickPlan, approaches, plan_pick
from robot_sim.studies.grape_scene import GrapeScene
from robot_sim.trajectories import Trajectory

SELF_PAIRS = tuple(
    (tool, link)
    for tool in ("palm", "finger_left", "finger_right", "tray", "blade_left", "blade_right")
    for link in ("base_link", "link1", "link2")
)
HARMFUL = ("palm", "finger_left", "finger_right", "blade_left", "blade_right")
MOST_PLANS = 8
LEAST_CLEARANCE_M = -0.02
"""Approaches whose control spheres overlap more than this are not worth planning."""
LEAST_TRAY_RAD = math.radians(20.0)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of one pick. failure is empty on success, else the first thing that went wrong."""

    overlapping: bool
    failure: str
    path_m: float
    key_points: int
    collision: bool
    minima: int
    plans: int
    tray_deg: float
    height_m: float
    error_x_m: float
    error_z_m: float

    @property
    def success(self) -> bool:
        """Clamped, carried, cut, delivered, and no finger or blade touched a bunch."""
        return not self.failure


@dataclass(slots=True)
class PickWorld:
    """An arm in a collision world, reused from trial to trial."""

    world: CollisionWorld
    arm: SphericalWristArm
    arm_config: GrapeArmConfig
    study: GrapeStudyConfig
    path_field: FieldConfig
    q_start: FloatArray
    _names: tuple[str, ...] = field(init=False)

    def __post_init__(self) -> None:
        self._names = tuple(j.name for j in self.arm.chain.joints)

    def place(self, q: FloatArray, tool: FloatArray) -> None:
        """Set arm and tool joints."""
        self.world.set_joints(dict(zip(self._names, q, strict=True)) | dict(zip(TOOL_JOINTS, tool, strict=True)))

    def clear(self) -> None:
        """Take all bodies out."""
        for name in self.world.bodies:
            self.world.remove_body(name)

    def add_seen(self, seen: GrapeScene) -> tuple[str, ...]:
        """The planner's picture: cylinders, cane, post; returns the names."""
        for i, b in enumerate(seen.bunches):
            self.world.add_solid(f"seen{i}", b.volume)
        return (*(f"seen{i}" for i in range(len(seen.bunches))), *self._add_obstacles(seen, "seen_"))

    def add_true(self, scene: GrapeScene) -> tuple[str, ...]:
        """The truth: berries, cane, post; returns the names."""
        for i, b in enumerate(scene.bunches):
            self.world.add_spheres(f"bunch{i}", b.berries_m, b.radii_m)
        return (*(f"bunch{i}" for i in range(len(scene.bunches))), *self._add_obstacles(scene, ""))

    def _add_obstacles(self, scene: GrapeScene, prefix: str) -> tuple[str, ...]:
        self.world.add_solid(f"{prefix}cane", scene.cane)
        if scene.post is None:
            return (f"{prefix}cane",)
        self.world.add_solid(f"{prefix}post", scene.post)
        return (f"{prefix}cane", f"{prefix}post")

    def sweep(self, q: FloatArray, tool: FloatArray, bodies: Sequence[str], skip: Sequence[str] = ()) -> list[Contact]:
        """First contacts along joint values (M, 6), links in skip left out; empty when the way is free."""
        for row in self.dense(q):
            self.place(row, tool)
            hits = [h for h in self.world.contacts(0.0, bodies) if h.link not in skip]
            hits += self.world.self_contacts(SELF_PAIRS)
            if hits:
                return hits
        return []

    def dense(self, q: FloatArray) -> FloatArray:
        """Joint values between key points, close enough that the tool moves no further than the check's step."""
        p = self.arm.chain.forward(q)[:, :3, 3]
        out = [q[:1]]
        for a, b, size in zip(q[:-1], q[1:], np.linalg.norm(np.diff(p, axis=0), axis=1), strict=True):
            turn = float(np.abs(b - a).max())
            count = max(1, int(np.ceil(max(size / self.study.check_m, turn / 0.06))))
            out.append(a + np.linspace(0, 1, count + 1)[1:, None] * (b - a))
        return np.concatenate(out)


def find_plan(at: PickWorld, seen: GrapeScene, height_m: float | None = None) -> tuple[PickPlan | None, str, int]:
    """The first approach, best clearance first, whose whole pick is free in the seen scene.

    Returns the plan or None, the last reason against one, and how many plans were checked with the whole arm.
    """
    names = at.add_seen(seen)
    reason, tries, found = "path.no_room", 0, None
    for option in approaches(seen, at.arm_config, at.study, height_m):
        if tries == MOST_PLANS or option.clearance_m < LEAST_CLEARANCE_M:
            break
        plan = plan_pick(seen, option, at.arm, at.arm_config, at.study, at.path_field, at.q_start)
        if isinstance(plan, str):
            reason = plan
            continue
        tries += 1
        legs, why = _checked_legs(at, plan, seen, names)
        if not why:
            found = replace(plan, legs=legs)
            break
        reason = why
    for name in names:
        at.world.remove_body(name)
    return found, reason, tries


def _checked_legs(at: PickWorld, plan: PickPlan, seen: GrapeScene, names: tuple[str, ...]) -> tuple[Legs, str]:
    """The pick's motions, each the smoothest that is free in the seen scene, and what the first bad one runs into.

    The tray may touch bunches on the way back; the bunch it carries must not be pressed into the other one.
    """
    a, study = plan.approach, at.study
    tool = a.tool()
    held = tool_values(2 * study.stem_radius_m, 0.6 * math.radians(at.arm_config.tray_deg), 0.0)
    own = f"seen{a.bunch}"
    rest = [n for n in names if n != own]

    def meets(leg: Trajectory, values: FloatArray, bodies: Sequence[str], skip: Sequence[str] = ()) -> str:
        hits = at.sweep(swept_rows(at.arm, leg, study.check_m), values, bodies, skip)
        return f"arm meets {hits[0].body.removeprefix('seen_')} ({hits[0].link})" if hits else ""

    def carries(leg: Trajectory) -> str:
        poses = at.arm.chain.forward(np.vstack([plan.pick_q[-1:], swept_rows(at.arm, leg, study.check_m)]))
        return carried_volume_hit(seen, a.bunch, poses, study.press_m)

    def laden(leg: Trajectory) -> str:
        return carries(leg) or meets(leg, held, rest, ("tray",))

    wanted: tuple[tuple[FloatArray, float, Callable[[Trajectory], str]], ...] = (
        (plan.out_q, study.speed_m_s, lambda leg: meets(leg, tool, names)),
        (plan.pick_q, study.speed_m_s / 2, lambda leg: meets(leg, tool, names)),
        (plan.pick_q[::-1], study.speed_m_s / 2, laden),
        (plan.basket_q, study.speed_m_s, laden),
    )
    legs, straightened = [], 0
    for q, speed, hits in wanted:
        leg, why, straighter = free_leg(at.arm, q, speed, hits)
        if why:
            return plan.legs, why
        legs.append(leg)
        straightened += straighter
    return Legs(legs[0], legs[1], legs[2], legs[3], straightened), ""


def run_pick(
    at: PickWorld, scene: GrapeScene, seen: GrapeScene, height_m: float | None = None
) -> tuple[Outcome, PickPlan | None]:
    """Plan on the seen scene, carry out on the true one."""
    at.clear()
    plan, reason, tries = find_plan(at, seen, height_m)
    pair = len(scene.bunches) > 1
    if plan is None:
        return Outcome(
            pair, f"no plan: {reason}", math.nan, 0, False, 0, tries, math.nan, math.nan, math.nan, math.nan
        ), None
    names = at.add_true(scene)
    failure, tray = _carry_out(at, scene, plan, names)
    at.clear()
    a = plan.approach
    T = at.arm.chain.forward(plan.pick_q[-1])
    miss = inverse_pose(T)[:3, :3] @ (scene.bunches[a.bunch].top_m - T[:3, 3])
    return (
        Outcome(
            pair,
            failure,
            path_length(plan.key_points_m),
            len(plan.key_points_m),
            failure.startswith("touch"),
            plan.minima,
            tries,
            tray,
            a.height_m,
            float(miss[0]),
            float(miss[2]),
        ),
        plan,
    )


def _touch(hits: list[Contact]) -> str:
    worst = min(hits, key=lambda h: h.distance_m)
    return f"touch: {worst.link} meets {worst.body}"


def _carry_out(at: PickWorld, scene: GrapeScene, plan: PickPlan, names: tuple[str, ...]) -> tuple[str, float]:
    """Clamp, hold, cut, deliver; returns what failed ('' for nothing) and the tray angle in deg."""
    a, study = plan.approach, at.study
    bunch = scene.bunches[a.bunch]
    tool = a.tool()
    out, way_in, back, basket = (
        swept_rows(at.arm, leg, study.check_m / 2)
        for leg in (plan.legs.out, plan.legs.pick, plan.legs.back, plan.legs.basket)
    )
    hits = at.sweep(out, tool, names) or at.sweep(way_in, tool, names)
    if hits:
        return _touch(hits), math.nan
    q = plan.pick_q[-1]
    T = at.arm.chain.forward(q)
    stem = inverse_pose(T)[:3, :3] @ (bunch.top_m - T[:3, 3])
    half = at.arm_config.finger_length_m / 2
    inside = abs(stem[0]) < a.opening_m / 2 - study.stem_radius_m and abs(stem[2]) < half - 0.005
    above = -stem[1]  # the bunch's top under the finger centre, as height over it
    if not inside:
        return "clamp: the peduncle is not between the fingers", math.nan
    if not 0 < -above < bunch.peduncle_m:
        return "clamp: no peduncle at the fingers' height", math.nan
    # fingers close until the pressure sensor feels the peduncle
    for opening in np.linspace(a.opening_m, 2 * study.stem_radius_m, 10):
        at.place(q, tool_values(float(opening), 0.0, a.blade_rad))
        hits = [h for h in at.world.contacts(0.0, names) if h.link in HARMFUL]
        if hits:
            return _touch(hits), math.nan
    closed = 2 * study.stem_radius_m
    tray = _hold(at, q, closed, a, f"bunch{a.bunch}")
    if math.isnan(tray):
        return "hold: the tray meets no berry", tray
    if tray < LEAST_TRAY_RAD:
        return f"hold: the tray stops at {math.degrees(tray):.0f} deg", math.degrees(tray)
    cut = _cut(at, q, closed, tray, a, stem, names)
    if cut:
        return cut, math.degrees(tray)
    held = tool_values(closed, tray, 0.0)
    others = [n for n in names if n != f"bunch{a.bunch}"]
    obstacles = [n for n in others if not n.startswith("bunch")]
    for rows in (back, basket):  # the tray may brush the neighbour, nothing else may
        hits = at.sweep(rows, held, obstacles) or at.sweep(rows, held, others, skip=("tray",))
        if hits:
            return _touch(hits), math.degrees(tray)
    poses = at.arm.chain.forward(np.vstack([q[None], back, basket]))
    return carried_hit(scene, a.bunch, poses, study.press_m), math.degrees(tray)


def _hold(at: PickWorld, q: FloatArray, opening_m: float, a: Approach, target: str) -> float:
    """Angle at which the tray meets the target bunch, swinging up from behind and below; NaN when it never does."""
    for angle in np.radians(np.arange(0.0, at.arm_config.tray_deg + 1e-9, 2.0)):
        at.place(q, tool_values(opening_m, float(angle), a.blade_rad))
        if any(h.link == "tray" for h in at.world.contacts(0.0, [target])):
            return float(angle)
    return math.nan


def _cut(
    at: PickWorld,
    q: FloatArray,
    opening_m: float,
    tray_rad: float,
    a: Approach,
    stem: FloatArray,
    names: tuple[str, ...],
) -> str:
    """Blades close over the peduncle, which the fingers have drawn to their middle."""
    c = at.arm_config
    pivot_z = -(c.blade_length_m - c.finger_length_m / 2)
    reach = float(stem[2]) - pivot_z
    if not 0.01 < reach < c.blade_length_m:
        return "cut: the peduncle is beyond the blades"
    for blade in np.linspace(a.blade_rad, 0.0, 8):
        at.place(q, tool_values(opening_m, tray_rad, float(blade)))
        hits = [h for h in at.world.contacts(0.0, names) if h.link in HARMFUL]
        if hits:
            return _touch(hits)
    return ""
