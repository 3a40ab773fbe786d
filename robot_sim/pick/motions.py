"""All motions of one pick, from the posture at its begin to the hand over the box, checked posture by posture."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import islice

import numpy as np

from robot_sim.config import RobotConfig
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.pick.arm_space import ArmSpace, Carried
from robot_sim.pick.grasp import Grasp
from robot_sim.pick.paths import find_way, grip, hand_line, right_for, timed
from robot_sim.pick.refusal import Refusal
from robot_sim.pick.release import Release, releases, under_grip_m
from robot_sim.plants import Fruit
from robot_sim.reasons import RobotReason
from robot_sim.trajectories import Trajectory

PLACES_TRIED, BY_TREE = 16, 2
"""Places for the box that are tried with straight ways, and then with searched ones, which take longer."""
SAMPLE_S = 0.04
TUCKED_DEG = (-5.0, 0.0, 95.0)
"""C1, C2 and bend of the right arm drawn back."""


class Leg(StrEnum):
    """The motions of a pick, in order.

    TUCK: the right arm out of the way before the chassis or the lift moves; often not needed. REACH: to before the
    fruit. CLOSE_IN: round it; the box is up by then. RETREAT: back from the plant and over the box. LOWER: into it.
    """

    TUCK = "tuck"
    REACH = "reach"
    CLOSE_IN = "close_in"
    RETREAT = "retreat"
    LOWER = "lower"


@dataclass(frozen=True, slots=True, eq=False)
class Motions:
    """Right and left arm (6,) over time. found_by: what found the way to before the fruit (robot_sim.pick.paths)."""

    legs: Mapping[Leg, Trajectory]
    found_by: str


def tuck(space: ArmSpace, q_now: FloatArray) -> Trajectory | None:
    """The right arm drawn back to the mast, forearm level; None when no way leads there."""
    tucked = np.append(np.radians(TUCKED_DEG), q_now[3:])
    way = find_way(space, q_now, tucked, None)
    return None if way is None else timed(way.postures, space.config)


def motions(space: ArmSpace, grasp: Grasp, fruit: Fruit) -> Motions | Refusal:
    """The motions of a pick that begins at the space's start."""
    free = space.check()
    at_fruit = np.append(grasp.q_right, space.start[3:])
    right = right_for(space, grip(space, at_fruit) - space.config.pick.approach_m * grasp.approach)
    if right is None or not free(at_fruit) or not free(np.append(right, space.start[3:])):
        return Refusal(RobotReason.PICK_NO_PATH, "other fruit or the plant is in the way; choose another fruit")
    hanging = carried(fruit, space.config)
    places = list(islice(_places(space, fruit, hanging), PLACES_TRIED))
    reached = False
    for search, some in ((False, places), (True, places[:BY_TREE])):
        for release in some:
            ready, closed = (np.append(q, release.over[3:]) for q in (right, grasp.q_right))
            close_in = hand_line(space, ready, closed)
            if close_in is None or not all(free(q) for q in close_in):
                continue
            after = _after(space, ready, closed, release, hanging, search)
            if after is None:
                continue
            # the box comes up while the right arm reaches out
            reach = find_way(space, space.start, ready, None, search=search)
            reached = reached or reach is not None
            if reach is None:
                continue
            legs = {Leg.REACH: timed(reach.postures, space.config), Leg.CLOSE_IN: timed(close_in, space.config)} | after
            if _keep_clear(space, legs, {Leg.RETREAT: closed, Leg.LOWER: release.over}, hanging):
                return Motions(legs, reach.found_by)
    if places and not reached:
        return Refusal(RobotReason.PICK_NO_PATH, "no way leads there; lower both arms or choose another fruit")
    return Refusal(RobotReason.PICK_NO_BOX, "there is no room for the box beside other fruit; choose another fruit")


def carried(fruit: Fruit, config: RobotConfig) -> Carried:
    """A fruit in the gripper."""
    below = under_grip_m(fruit, config.pick.grip_under_top_m)
    # berries stand out of a bunch's middle
    radius = max(part.size_m[0] for part in fruit.parts) + (0.0 if fruit.crop == "cucumber" else 0.02)
    places = np.linspace(0.0, below - radius, 5)
    return Carried(places, np.full(len(places), radius))


def _places(space: ArmSpace, fruit: Fruit, hanging: Carried) -> Iterator[Release]:
    """Places for the box that are free of plants, the nearest to the mast first."""
    below = under_grip_m(fruit, space.config.pick.grip_under_top_m)
    for release in releases(below, space.config):
        if all((space.gaps(q, hanging) >= 0.0).all() for q in (release.over, release.lowered)):
            yield release


def _after(
    space: ArmSpace, ready: FloatArray, closed: FloatArray, release: Release, hanging: Carried, search: bool
) -> dict[Leg, Trajectory] | None:
    """From the fruit back along the approach, over the box and into it; None where that is not free.

    search: look for a way over the box where the straight one is not free.
    """
    back = hand_line(space, closed, ready)
    lower = hand_line(space, release.over, release.lowered)
    if back is None or lower is None:
        return None
    at_fruit = replace(space, start=closed)
    over = hand_line(space, ready, release.over)
    if over is None or not at_fruit.along(over, hanging):
        way = find_way(at_fruit, ready, release.over, hanging, search=search)
        if way is None:
            return None
        over = way.postures
    return {
        Leg.RETREAT: timed(np.concatenate([back, over[1:]]), space.config),
        Leg.LOWER: timed(lower, space.config),
    }


def _keep_clear(
    space: ArmSpace, legs: Mapping[Leg, Trajectory], starts: Mapping[Leg, FloatArray], hanging: Carried
) -> bool:
    """Whether the smooth motions, which cut the corners of their paths a little, are free as well."""
    for leg, motion in legs.items():
        loaded = leg in starts
        here = replace(space, start=starts[leg]) if loaded else space
        if not here.along(motion.sample(SAMPLE_S).q, hanging if loaded else None):
            return False
    return True
