"""The greenhouse row: gutters, plants, cucumbers and tomatoes as primitives; the same seed gives the same crop.

World frame: x along the aisle, y left, z up, floor at z = 0. Each row has its own crop.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from robot_sim.config import GreenhouseConfig
from robot_sim.plants import Crop, Fruit, grow
from robot_sim.primitives import Primitive, Rgba

__all__ = ["Greenhouse", "Primitive", "greenhouse", "solid"]

CONCRETE: Rgba = (0.62, 0.63, 0.60, 1.0)
SOIL: Rgba = (0.88, 0.89, 0.87, 1.0)
STEEL: Rgba = (0.72, 0.75, 0.76, 1.0)
GUTTER: Rgba = (0.94, 0.95, 0.95, 1.0)
SLAB: Rgba = (0.35, 0.29, 0.23, 1.0)

WIRE_OVER_PLANT_M = 0.05


@dataclass(frozen=True, slots=True)
class Greenhouse:
    """parts: what stands still. leaves: those of them that are sprayed. fruits: what can be picked."""

    parts: tuple[Primitive, ...]
    leaves: tuple[Primitive, ...]
    fruits: tuple[Fruit, ...]
    diseased: frozenset[str] = frozenset()
    """Names of the plants with mildew."""

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """Everything to draw, fruit where it hangs at the start."""
        return (*self.parts, *(part for fruit in self.fruits for part in fruit.parts))


def greenhouse(config: GreenhouseConfig, seed: int = 0) -> Greenhouse:
    """The whole greenhouse, about 9,000 triangles with 8-sided cylinders and 8 x 6 spheres."""
    rng, health = np.random.default_rng(seed), np.random.default_rng((seed, 1))
    diseased: set[str] = set()
    parts = [*_floor(config)]
    fruits: list[Fruit] = []
    rows: tuple[tuple[float, Crop], ...] = ((1.0, config.left_crop), (-1.0, config.right_crop))
    for side, crop in rows:
        parts += _gutter(config, side)
        length = config.row_end_m - config.row_start_m
        count = int(length / config.plant_spacing_m)
        first = config.row_start_m + 0.5 * (length - (count - 1) * config.plant_spacing_m)
        for i in range(count):
            # twice the same crop needs two names
            name = f"{crop}_{i}" if side > 0 or config.left_crop != config.right_crop else f"{crop}_r{i}"
            plant = grow(config, name, crop, first + i * config.plant_spacing_m, side, rng, health)
            diseased |= {name} if plant.diseased else set()
            parts += plant.parts
            fruits += plant.fruits
    return Greenhouse(tuple(parts), tuple(p for p in parts if "_leaf_" in p.name), tuple(fruits), frozenset(diseased))


def solid(parts: tuple[Primitive, ...]) -> tuple[Primitive, ...]:
    """What the robot can run into."""
    return tuple(p for p in parts if p.solid)


def _floor(config: GreenhouseConfig) -> list[Primitive]:
    length = config.row_end_m - config.row_start_m
    middle = 0.5 * (config.row_end_m + config.row_start_m)
    level = (0.0, 0.0, 0.0)
    return [
        Primitive("ground", "box", (length + 3.0, 4.4, 0.02), (middle, 0.0, -0.014), level, SOIL),
        Primitive("aisle", "box", (length + 3.0, 1.30, 0.02), (middle, 0.0, -0.0105), level, CONCRETE),
    ]


def _gutter(config: GreenhouseConfig, side: float) -> list[Primitive]:
    length = config.row_end_m - config.row_start_m
    middle = 0.5 * (config.row_end_m + config.row_start_m)
    y, w, z = side * config.row_offset_m, config.gutter_width_m, config.gutter_height_m
    level, lying = (0.0, 0.0, 0.0), (0.0, pi / 2, 0.0)
    wire = z + config.plant_height_m + WIRE_OVER_PLANT_M
    row = "left" if side > 0 else "right"
    parts = [
        Primitive(f"gutter_{row}", "box", (length, w, 0.07), (middle, y, z + 0.035), level, GUTTER, True),
        Primitive(f"slab_{row}", "box", (length - 0.1, w * 0.75, 0.06), (middle, y, z + 0.095), level, SLAB),
        Primitive(f"wire_{row}", "cylinder", (0.006, length), (middle, y, wire), lying, STEEL),
        # heating pipes under the gutter
        *(
            Primitive(
                f"pipe_{row}_{k}",
                "cylinder",
                (0.025, length),
                (middle, y + side * (0.06 - 0.16 * k), 0.08),
                lying,
                STEEL,
            )
            for k in (0, 1)
        ),
    ]
    posts = max(2, round(length / 1.6) + 1)
    for i in range(posts):
        x = config.row_start_m + 0.05 + (length - 0.1) * i / (posts - 1)
        leg = Primitive(f"leg_{row}_{i}", "box", (0.04, 0.04, z), (x, y, 0.5 * z), level, STEEL, True)
        pole_y = y + side * (0.5 * w + 0.02)
        pole = Primitive(f"pole_{row}_{i}", "box", (0.03, 0.03, wire), (x, pole_y, 0.5 * wire), level, STEEL, True)
        parts += [leg, pole]
    return parts
