"""Plans one pick: how to stand, the way to the fruit, back and to the box; or says why not and what to do."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from math import ceil, degrees, hypot, sin

import numpy as np

from robot_sim.arm_angles import arm_joint_names
from robot_sim.config import RobotConfig
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.pick.arm_space import ROUNDING_M, ArmSpace
from robot_sim.pick.grasp import Grasp, grasps, grasps_here, grip_point_m
from robot_sim.pick.motions import Leg, Motions, motions, tuck
from robot_sim.pick.paths import grip
from robot_sim.pick.refusal import Refusal
from robot_sim.pick.release import releases
from robot_sim.pick.surroundings import scene_around
from robot_sim.planner import Scene, Sphere
from robot_sim.plants import Fruit
from robot_sim.primitives import Primitive
from robot_sim.reasons import RobotReason
from robot_sim.stance import Stance, stance_of
from robot_sim.state import RobotState
from robot_sim.trajectories import Trajectory

GRASPS_TRIED = 3
SHOWN = 24
"""Points of one line of the preview."""
GRIPPERS = {"cucumber": "long", "tomato": "soft", "grape": "soft"}


@dataclass(frozen=True, slots=True, eq=False)
class Scenery:
    """What is known of the greenhouse. standing: what an arm must not touch (robot_sim.pick.surroundings.hard)."""

    standing: tuple[Primitive, ...]
    grown: tuple[Fruit, ...]


@dataclass(frozen=True, slots=True, eq=False)
class PickPlan:
    """One pick from where the robot stands.

    drive_m: straight on first. stance: where that ends, and the lift's height there. motions: right and left arm (6,)
    over time, from the posture at the time of planning. shown_m: the grip point's way to the fruit and from there to
    the box, in the world, (M, 3) each. found_by: what found the way to the fruit (robot_sim.pick.paths).
    """

    fruit: str
    drive_m: float
    stance: Stance
    motions: Mapping[Leg, Trajectory]
    shown_m: tuple[FloatArray, FloatArray]
    found_by: str

    @property
    def duration_s(self) -> float:
        """Time of the arms' motions alone [s]."""
        return sum(motion.duration_s for motion in self.motions.values())


def where_fruits_are(scenery: Scenery, state: RobotState) -> dict[str, tuple[float, ...]]:
    """Fruit that still hangs -> where its middle is now, world [m]."""
    places: dict[str, tuple[float, ...]] = {}
    for fruit in scenery.grown:
        if state.fruits.get(fruit.name, "hanging").startswith("hanging"):
            # the first part of a fruit is its body or its axis, at its middle
            moved = state.moved.get(fruit.parts[0].name)
            places[fruit.name] = fruit.xyz_m if moved is None or fruit.crop != "cucumber" else moved[:3]
    return places


def plan_pick(
    name: str, scenery: Scenery, state: RobotState, config: RobotConfig, *, stay: bool = False
) -> PickPlan | Refusal:
    """The pick of one fruit from the present posture, or why it cannot be. stay: chassis and lift keep their place."""
    fruit = next((f for f in scenery.grown if f.name == name), None)
    places = where_fruits_are(scenery, state)
    if fruit is None:
        return Refusal(RobotReason.PICK_NO_FRUIT, f"the robot knows of no fruit '{name}'")
    if name not in places:
        return Refusal(RobotReason.PICK_NOT_HANGING, f"{name} does not hang any more; choose another fruit")
    if (needed := GRIPPERS[fruit.crop]) != config.tool.gripper:
        return Refusal(
            RobotReason.UNKNOWN_TOOL,
            f"a {fruit.crop} wants the {needed} gripper, the robot has the {config.tool.gripper} one; "
            f"start with robot.tool.gripper = '{needed}'",
        )
    stance = stance_of(state)
    grip_m = grip_point_m(fruit, places[name], config)
    along = abs(sin(stance.yaw_rad)) <= sin(config.pick.aligned_rad)
    most_m = config.pick.correction_m if along else 0.0
    found = grasps_here(stance, grip_m, config) if stay else grasps(stance, grip_m, most_m, config)
    tried = list(islice(found, GRASPS_TRIED))
    if not tried:
        return _out_of_reach(stance, grip_m, along, config)
    q_now, q_rear = _posture(state), _arm(state, "rear")

    def space_at(there: Stance) -> ArmSpace:
        scene = scene_around(there, scenery.standing, places, scenery.grown, name, config)
        return ArmSpace(config, scene, q_rear, q_now, 0.0 if stay else config.pick.arrived_m)

    refusal = None
    for grasp in tried:
        space, away = space_at(grasp.stance), None
        before = np.minimum(0.0, space_at(stance).gaps(q_now) - ROUNDING_M)
        if any((space_at(there).gaps(q_now) < before).any() for there in _on_the_way(stance, grasp)):
            away = tuck(space_at(stance), q_now)
            if away is None:
                refusal = Refusal(RobotReason.PICK_NO_PATH, "lower both arms, then ask again")
                continue
            space = replace(space, start=away.at(away.duration_s).q[0])
        way = motions(space, grasp, fruit)
        if isinstance(way, Motions):
            return _planned(name, grasp, way, away, space)
        refusal = refusal or way
    assert refusal is not None
    return refusal


def _planned(name: str, grasp: Grasp, found: Motions, away: Trajectory | None, space: ArmSpace) -> PickPlan:
    legs = found.legs if away is None else {Leg.TUCK: away, **found.legs}
    out, back = ((Leg.REACH, Leg.CLOSE_IN), (Leg.RETREAT, Leg.LOWER))
    shown = tuple(_line(space, grasp.stance, [legs[leg] for leg in part]) for part in (out, back))
    return PickPlan(name, grasp.drive_m, grasp.stance, legs, (shown[0], shown[1]), found.found_by)


def _on_the_way(stance: Stance, grasp: Grasp) -> Iterator[Stance]:
    """Stances between two, every 5 cm of drive and of lift together; none when nothing moves."""
    rise_m = grasp.stance.lift_m - stance.lift_m
    count = ceil(max(abs(grasp.drive_m), abs(rise_m)) / 0.05)
    for k in range(1, count + 1):
        yield replace(stance.driven(grasp.drive_m * k / count), lift_m=stance.lift_m + rise_m * k / count)


def _posture(state: RobotState) -> FloatArray:
    return np.concatenate([_arm(state, "right"), _arm(state, "left")])


def _arm(state: RobotState, name: str) -> FloatArray:
    return np.array([state.target_rad[joint] for joint in arm_joint_names(name)])  # type: ignore[arg-type]


def _out_of_reach(stance: Stance, grip_m: FloatArray, along: bool, config: RobotConfig) -> Refusal:
    """What would bring a fruit into reach: a drive, a turn, or nothing."""
    ahead = stance.to_disc(grip_m, config)
    if ahead[0] < 0.0:
        return Refusal(RobotReason.PICK_BEHIND, "it hangs behind the chest; turn the disc or the robot by 180 deg")
    found = next(grasps(stance, grip_m, 3.0, config), None)
    if found is not None and along:
        way = "forward" if found.drive_m > 0 else "back"
        return Refusal(
            RobotReason.PICK_OUT_OF_REACH,
            f"drive {abs(found.drive_m):.2f} m {way} first, then ask again",
            found.drive_m,
        )
    if found is not None or not along:
        return Refusal(
            RobotReason.PICK_OUT_OF_REACH,
            f"turn the robot along the row first (it stands {degrees(stance.yaw_rad):.0f} deg off), then ask again",
        )
    far = hypot(*ahead[:2])
    return Refusal(
        RobotReason.PICK_OUT_OF_REACH,
        f"it hangs {far:.2f} m beside and {grip_m[2]:.2f} m up, where no posture of the arm reaches; choose another",
    )


def _line(space: ArmSpace, stance: Stance, motions: Sequence[Trajectory]) -> FloatArray:
    """The grip point along motions, in the world, as few points."""
    postures = np.concatenate([m.at(np.linspace(0.0, m.duration_s, SHOWN // len(motions))).q for m in motions])
    return stance.to_world(np.array([grip(space, q) for q in postures]), space.config)


def warm_up(config: RobotConfig) -> None:
    """Compile the kernels and lay out the places for the box, so that the first plan takes no longer than others."""
    sphere = Sphere(np.eye(4), 0.1)
    space = ArmSpace(config, Scene((sphere,)), np.zeros(3), np.zeros(6))
    space.check()(np.zeros(6))
    next(releases(0.13, config), None)
