"""Plants as they grow: stem, leaves, and the fruit that hangs from its peduncle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from typing import Literal

import numpy as np

from robot_sim.config import GreenhouseConfig
from robot_sim.primitives import Primitive, Rgba, Vec3, rod, rotation, rpy_of

Crop = Literal["cucumber", "tomato", "grape"]
STEM: Rgba = (0.36, 0.56, 0.22, 1.0)
LEAVES: tuple[Rgba, ...] = ((0.13, 0.40, 0.15, 1.0), (0.17, 0.47, 0.18, 1.0), (0.23, 0.54, 0.22, 1.0))
CUCUMBER: Rgba = (0.10, 0.34, 0.12, 1.0)
CUCUMBER_TIP: Rgba = (0.46, 0.58, 0.24, 1.0)
RIPE: Rgba = (0.83, 0.13, 0.09, 1.0)
UNRIPE: tuple[Rgba, ...] = ((0.88, 0.45, 0.12, 1.0), (0.52, 0.65, 0.25, 1.0))

GRAPE: Rgba = (0.28, 0.12, 0.34, 1.0)
GRAPE_UNRIPE: Rgba = (0.55, 0.66, 0.33, 1.0)
YOUNG_CUCUMBER: Rgba = (0.50, 0.68, 0.30, 1.0)
MILDEW: tuple[Rgba, ...] = ((0.62, 0.63, 0.40, 1.0), (0.70, 0.68, 0.48, 1.0), (0.55, 0.57, 0.33, 1.0))
"""Leaves of a plant with powdery mildew: pale and yellowish."""
TOUGHNESS: dict[Crop, float] = {"cucumber": 1.0, "tomato": 0.6, "grape": 0.55}
"""Share of ToolConfig.bruise_n that damages a fruit; choice: berries bruise first, but a bunch that is rigid here lands
on one of them where a real one lands on several."""

FRUIT_KG_M3 = 950.0
"""Cucumbers and tomatoes are nearly all water, and float."""
PEDUNCLE_M = 0.08
"""How far a fruit hangs under the bend of its peduncle; there the cutter can cut."""


@dataclass(frozen=True, slots=True)
class Fruit:
    """One fruit (a cucumber, a truss of cherry tomatoes, a bunch of grapes) as it hangs at the start.

    xyz_m: its middle; top_m: from there up to where the peduncle begins. parts: what moves with it.
    """

    name: str
    crop: Crop
    xyz_m: Vec3
    top_m: float
    mass_kg: float
    ripe: bool
    parts: tuple[Primitive, ...]


@dataclass(frozen=True, slots=True)
class Plant:
    """One plant: what stands still, its leaves among it, and its fruit."""

    parts: tuple[Primitive, ...]
    fruits: tuple[Fruit, ...]
    diseased: bool = False


def grow(
    config: GreenhouseConfig,
    name: str,
    crop: Crop,
    x_m: float,
    side: float,
    rng: np.random.Generator,
    health: np.random.Generator,
) -> Plant:
    """A plant at ``x_m`` in the row on ``side`` (+1 left, -1 right of the aisle).

    rng decides how it grew, health whether it is diseased and which of its fruit is ripe.
    """
    diseased = bool(health.random() < config.diseased_share)
    y0 = side * config.row_offset_m
    z0 = config.gutter_height_m + 0.12
    z1 = config.gutter_height_m + config.plant_height_m
    parts = [rod(f"{name}_stem", (x_m, y0, z0), (x_m + rng.uniform(-0.04, 0.04), y0, z1), 0.009, STEM)]
    for k in range(config.leaves_per_plant):
        up = z0 + 0.10 + (z1 - z0 - 0.08) * (k + rng.uniform(0.0, 0.6)) / max(1, config.leaves_per_plant)
        # leaves stand around the stem by the golden angle, as phyllotaxis has it
        yaw = 2.399963 * k + float(rng.uniform(-0.3, 0.3))
        size = float((0.20 if crop == "tomato" else 0.26) * rng.uniform(0.75, 1.1))
        reach = 0.06 + 0.45 * size
        at = (float(x_m + reach * np.cos(yaw)), float(y0 + 0.75 * reach * np.sin(yaw)), float(up))
        # the large leaves of cucumber and vine hang, a tomato's stand out
        droop = float(rng.uniform(0.25, 0.75) if crop == "tomato" else rng.uniform(0.55, 1.1))
        colour = (MILDEW if diseased else LEAVES)[int(rng.integers(len(LEAVES)))]
        parts += _leaf(f"{name}_leaf_{k}", at, size, droop, yaw, crop != "tomato", colour)
    fruits = []
    span = (config.fruit_high_m - config.fruit_low_m) / max(1, config.fruits_per_plant)
    for k in range(config.fruits_per_plant):
        # a truss or bunch bears several: half as many of them
        if crop != "cucumber" and k % 2 == 1:
            continue
        z = float(config.fruit_low_m + span * (k + rng.uniform(0.1, 0.9)))
        x = float(x_m + (-1) ** k * rng.uniform(0.06, 0.13))
        y = float(side * (config.fruit_offset_m + rng.uniform(0.0, 0.04)))
        fruit = GROWN[crop](f"{name}_fruit_{k}", (x, y, z), bool(health.random() < config.ripe_share), rng)
        fruits.append(fruit)
        top, bend = z + fruit.top_m, z + fruit.top_m + PEDUNCLE_M
        parts.append(rod(f"{fruit.name}_peduncle", (x, y, top), (x, y, bend), 0.0035, STEM))
        parts.append(rod(f"{fruit.name}_branch", (x, y, bend), (x_m, y0, bend + 0.05), 0.0035, STEM))
    return Plant(tuple(parts), tuple(fruits), diseased)


def _cucumber(name: str, at: Vec3, ripe: bool, rng: np.random.Generator) -> Fruit:
    length, radius = float(rng.uniform(0.16, 0.20)), float(rng.uniform(0.017, 0.021))
    # a young one is thin and pale
    radius *= 1.0 if ripe else 0.75
    skin = CUCUMBER if ripe else YOUNG_CUCUMBER
    turned = (0.0, 0.0, float(rng.uniform(0.0, pi)))
    parts = (
        Primitive(name, "cylinder", (radius, length), at, turned, skin),
        Primitive(f"{name}_tip", "cylinder", (radius * 0.72, length + 0.024), at, turned, CUCUMBER_TIP),
    )
    mass = FRUIT_KG_M3 * pi * radius**2 * length
    return Fruit(name, "cucumber", at, 0.5 * length, mass, ripe, parts)


def _truss(name: str, at: Vec3, ripe: bool, rng: np.random.Generator) -> Fruit:
    x, y, z = at
    parts = [rod(f"{name}_axis", (x, y, z + 0.07), (x, y, z - 0.05), 0.003, STEM)]
    mass = 0.0
    for k in range(3):
        radius = float(rng.uniform(0.017, 0.021))
        centre = (x + 0.020 * (-1) ** k, y + 0.014 * (-1) ** (k // 2), z + 0.040 - 0.042 * k)
        colour = RIPE if ripe else UNRIPE[k % 2]
        parts.append(Primitive(f"{name}_{k}", "sphere", (radius,), centre, (0.0, 0.0, 0.0), colour))
        mass += FRUIT_KG_M3 * 4.0 / 3.0 * pi * radius**3
    return Fruit(name, "tomato", at, 0.07, mass, ripe, tuple(parts))


def _bunch(name: str, at: Vec3, ripe: bool, rng: np.random.Generator) -> Fruit:
    """A small bunch of table grapes: rings of four, four, three and one berry that narrow downwards."""
    x, y, z = at
    parts = [rod(f"{name}_axis", (x, y, z + 0.075), (x, y, z - 0.045), 0.003, STEM)]
    mass, k = 0.0, 0
    for ring, (count, wide) in enumerate(((4, 0.024), (4, 0.022), (3, 0.016), (1, 0.0))):
        for i in range(count):
            radius = float(rng.uniform(0.015, 0.017))
            turn = 2.0 * pi * i / count + 0.7 * ring
            centre = (x + wide * float(np.cos(turn)), y + wide * float(np.sin(turn)), z + 0.045 - 0.031 * ring)
            skin = GRAPE if ripe else GRAPE_UNRIPE
            parts.append(Primitive(f"{name}_{k}", "sphere", (radius,), centre, (0.0, 0.0, 0.0), skin))
            mass += 1.1 * FRUIT_KG_M3 * 4.0 / 3.0 * pi * radius**3
            k += 1
    return Fruit(name, "grape", at, 0.075, mass, ripe, tuple(parts))


GROWN: dict[Crop, Callable[[str, Vec3, bool, np.random.Generator], Fruit]] = {
    "cucumber": _cucumber,
    "tomato": _truss,
    "grape": _bunch,
}


def _leaf(name: str, xyz: Vec3, size: float, droop: float, yaw: float, lobed: bool, rgba: Rgba) -> list[Primitive]:
    """A blade that droops away from the stem; two turned squares make a cucumber's lobes, one a tomato's leaflet."""
    thin = 0.004
    blade = Primitive(name, "box", (size, (0.80 if lobed else 0.42) * size, thin), xyz, (0.0, droop, yaw), rgba)
    if not lobed:
        # two leaflets beside the end one
        across = rotation((0.0, droop, yaw)) @ np.array([-0.18 * size, 0.0, 0.003])
        at = (xyz[0] + float(across[0]), xyz[1] + float(across[1]), xyz[2] + float(across[2]))
        pair = Primitive(f"{name}_pair", "box", (0.30 * size, 0.95 * size, thin), at, (0.0, droop, yaw), rgba)
        return [blade, pair]
    turned = rpy_of(rotation((0.0, droop, yaw)) @ rotation((0.0, 0.0, 0.25 * pi)))
    return [blade, Primitive(f"{name}_lobe", "box", (0.72 * size, 0.72 * size, 1.5 * thin), xyz, turned, rgba)]
