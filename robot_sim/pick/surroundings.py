"""What both arms must keep away from while picking: gutters, stems, other fruit, as solids in the disc's axes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import dist

import numpy as np

from robot_sim.capsules import arm_model
from robot_sim.config import RobotConfig
from robot_sim.kinematics.transforms import FloatArray, inverse_pose, rpy, translation
from robot_sim.planner import Box, Cylinder, Scene, Solid, Sphere
from robot_sim.plants import Fruit
from robot_sim.primitives import Primitive
from robot_sim.stance import Stance

NEAR_M = 1.5
"""What is further from the robot than this is out of its arms' way."""


def hard(parts: Iterable[Primitive]) -> tuple[Primitive, ...]:
    """What an arm must not run into of everything that stands: what is solid, and the plants' stems; leaves give."""
    return tuple(part for part in parts if part.solid or part.name.endswith("_stem"))


def solid_of(part: Primitive, T: FloatArray | None = None) -> Solid:
    """A primitive as a bounding solid. T: its pose (4, 4), by default where it stands."""
    if T is None:
        T = translation(*part.xyz_m) @ rpy(*part.rpy_rad)
    if part.kind == "sphere":
        return Sphere(T, part.size_m[0])
    if part.kind == "cylinder":
        return Cylinder(T, part.size_m[0], part.size_m[1])
    return Box(T, (0.5 * part.size_m[0], 0.5 * part.size_m[1], 0.5 * part.size_m[2]))


def solids_of_fruit(fruit: Fruit, at_m: Sequence[float]) -> list[Solid]:
    """A hanging fruit whose middle is at ``at_m`` (3,): a cucumber's body, the berries of a truss or bunch."""
    shift = np.asarray(at_m) - fruit.xyz_m
    solids = []
    for part in fruit.parts:
        if part.kind == "cylinder" and (fruit.crop != "cucumber" or part.name.endswith("_tip")):
            continue  # the axis of a truss; the tip is inside the rounded body below
        T = translation(*(part.xyz_m + shift)) @ rpy(*part.rpy_rad)
        solids.append(solid_of(part, T))
    return solids


def scene_around(
    stance: Stance,
    standing: Sequence[Primitive],
    fruits: Mapping[str, Sequence[float]],
    grown: Sequence[Fruit],
    without: str,
    config: RobotConfig,
) -> Scene:
    """What stands near the robot, in the disc's axes.

    standing: see :func:`hard`. fruits: name -> where its middle is now. without: the fruit that is to be picked.
    """
    solids = [solid_of(part) for part in standing if _near(stance, part)]
    for fruit in grown:
        at = fruits.get(fruit.name)
        if at is not None and fruit.name != without and dist(at[:2], (stance.x_m, stance.y_m)) < NEAR_M:
            solids += solids_of_fruit(fruit, at)
    T_disc_world = inverse_pose(stance.T_world_disc(config))
    arms = arm_model(config)
    shoulders, reach = arms.T_joint[:2, 0, :3, 3], arms.lever_m[:2, 0] + config.pick.plant_gap_m
    near = (_moved(solid, T_disc_world) for solid in solids)
    return Scene(tuple(solid for solid in near if (solid.distance(shoulders)[0] < reach).any()))


def _near(stance: Stance, part: Primitive) -> bool:
    """Whether any point of a part can be near the robot; long gutters reach along the whole row."""
    half = 0.5 * max(part.size_m)
    return dist(part.xyz_m[:2], (stance.x_m, stance.y_m)) < NEAR_M + half


def _moved(solid: Solid, T: FloatArray) -> Solid:
    if isinstance(solid, Sphere):
        return Sphere(T @ solid.T, solid.radius_m)
    if isinstance(solid, Cylinder):
        return Cylinder(T @ solid.T, solid.radius_m, solid.height_m)
    assert isinstance(solid, Box)
    return Box(T @ solid.T, solid.half_m)
