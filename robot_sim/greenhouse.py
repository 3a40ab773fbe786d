"""The greenhouse row: gutters, plants, cucumbers and tomatoes as primitives; the same seed gives the same crop.

World frame: x along the aisle, y left, z up, floor at z = 0. Cucumbers grow on the left (+y), tomatoes on the right.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, atan2, cos, hypot, pi, sin
from typing import Literal

import numpy as np
import numpy.typing as npt

from robot_sim.config import GreenhouseConfig

Rgba = tuple[float, float, float, float]
Vec3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Primitive:
    """One thing to draw. size_m: box (x, y, z), cylinder (radius, length; along its z), sphere (radius,).

    solid: whether the robot can run into it. rpy_rad: roll, pitch, yaw about fixed axes.
    """

    name: str
    kind: Literal["box", "cylinder", "sphere"]
    size_m: tuple[float, ...]
    xyz_m: Vec3
    rpy_rad: Vec3
    rgba: Rgba
    solid: bool = False


CONCRETE: Rgba = (0.62, 0.63, 0.60, 1.0)
SOIL: Rgba = (0.88, 0.89, 0.87, 1.0)
STEEL: Rgba = (0.72, 0.75, 0.76, 1.0)
GUTTER: Rgba = (0.94, 0.95, 0.95, 1.0)
SLAB: Rgba = (0.35, 0.29, 0.23, 1.0)
STEM: Rgba = (0.36, 0.56, 0.22, 1.0)
LEAVES: tuple[Rgba, ...] = ((0.13, 0.40, 0.15, 1.0), (0.17, 0.47, 0.18, 1.0), (0.23, 0.54, 0.22, 1.0))
CUCUMBER: Rgba = (0.10, 0.34, 0.12, 1.0)
CUCUMBER_TIP: Rgba = (0.46, 0.58, 0.24, 1.0)
RIPE: Rgba = (0.83, 0.13, 0.09, 1.0)
UNRIPE: tuple[Rgba, ...] = ((0.88, 0.45, 0.12, 1.0), (0.52, 0.65, 0.25, 1.0))

WIRE_OVER_PLANT_M = 0.05


def greenhouse(config: GreenhouseConfig, seed: int = 0) -> tuple[Primitive, ...]:
    """All scenery, about 9,000 triangles with 8-sided cylinders and 8 x 6 spheres."""
    rng = np.random.default_rng(seed)
    parts = [*_floor(config)]
    for side, crop in ((1.0, "cucumber"), (-1.0, "tomato")):
        parts += _gutter(config, side)
        length = config.row_end_m - config.row_start_m
        count = int(length / config.plant_spacing_m)
        first = config.row_start_m + 0.5 * (length - (count - 1) * config.plant_spacing_m)
        for i in range(count):
            x = first + i * config.plant_spacing_m
            parts += _plant(config, f"{crop}_{i}", crop, x, side, rng)
    return tuple(parts)


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


def _plant(
    config: GreenhouseConfig, name: str, crop: str, x: float, side: float, rng: np.random.Generator
) -> list[Primitive]:
    y0 = side * config.row_offset_m
    z0 = config.gutter_height_m + 0.12
    z1 = config.gutter_height_m + config.plant_height_m
    parts = [_rod(f"{name}_stem", (x, y0, z0), (x + rng.uniform(-0.04, 0.04), y0, z1), 0.009, STEM)]
    for k in range(config.leaves_per_plant):
        up = z0 + 0.10 + (z1 - z0 - 0.08) * (k + rng.uniform(0.0, 0.6)) / max(1, config.leaves_per_plant)
        # leaves stand around the stem by the golden angle, as phyllotaxis has it
        yaw = 2.399963 * k + rng.uniform(-0.3, 0.3)
        size = (0.22 if crop == "cucumber" else 0.17) * rng.uniform(0.75, 1.1)
        reach = 0.06 + 0.45 * size
        at = (x + reach * np.cos(yaw), y0 + 0.75 * reach * np.sin(yaw), up)
        droop = float(rng.uniform(0.25, 0.75))
        colour = LEAVES[int(rng.integers(len(LEAVES)))]
        xyz = (float(at[0]), float(at[1]), float(at[2]))
        parts += _leaf(f"{name}_leaf_{k}", xyz, float(size), droop, float(yaw), crop == "cucumber", colour)
    span = (config.fruit_high_m - config.fruit_low_m) / max(1, config.fruits_per_plant)
    for k in range(config.fruits_per_plant):
        z = config.fruit_low_m + span * (k + rng.uniform(0.1, 0.9))
        fx = x + rng.uniform(-0.12, 0.12)
        fy = side * (config.fruit_offset_m + rng.uniform(0.0, 0.06))
        if crop == "cucumber":
            parts += _cucumber(f"{name}_fruit_{k}", fx, fy, z, (x, y0), rng)
        elif k % 2 == 0:
            # a truss bears several: half as many of them
            parts += _truss(f"{name}_fruit_{k}", fx, fy, z, (x, y0), rng)
    return parts


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


def rotation(rpy_rad: Vec3) -> npt.NDArray[np.float64]:
    """(3, 3) rotation of roll, pitch, yaw about fixed axes: Rz Ry Rx, as in URDF."""
    (sr, cr), (sp, cp), (sy, cy) = ((sin(a), cos(a)) for a in rpy_rad)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rpy_of(R: npt.NDArray[np.float64]) -> Vec3:
    """Roll, pitch, yaw [rad] of a rotation whose pitch is not 90 degrees; the inverse of :func:`rotation`."""
    pitch = asin(min(1.0, max(-1.0, -R[2, 0])))
    return (atan2(R[2, 1], R[2, 2]), pitch, atan2(R[1, 0], R[0, 0]))


def _cucumber(
    name: str, x: float, y: float, z: float, stem: tuple[float, float], rng: np.random.Generator
) -> list[Primitive]:
    length, radius = float(rng.uniform(0.16, 0.22)), float(rng.uniform(0.017, 0.021))
    top = z + 0.5 * length
    upright = (0.0, 0.0, float(rng.uniform(0.0, pi)))
    return [
        Primitive(name, "cylinder", (radius, length), (x, y, z), upright, CUCUMBER),
        Primitive(f"{name}_tip", "cylinder", (radius * 0.72, length + 0.024), (x, y, z), upright, CUCUMBER_TIP),
        _rod(f"{name}_peduncle", (x, y, top), (stem[0], stem[1], top + 0.07), 0.0035, STEM),
    ]


def _truss(
    name: str, x: float, y: float, z: float, stem: tuple[float, float], rng: np.random.Generator
) -> list[Primitive]:
    ripe = rng.random() < 0.65
    parts = [
        _rod(f"{name}_peduncle", (x, y, z + 0.10), (stem[0], stem[1], z + 0.15), 0.0035, STEM),
        _rod(f"{name}_axis", (x, y, z + 0.10), (x, y, z - 0.05), 0.003, STEM),
    ]
    for k in range(3):
        colour = RIPE if ripe else UNRIPE[k % 2]
        radius = float(rng.uniform(0.017, 0.021))
        at = (x + 0.020 * (-1) ** k, y + 0.014 * (-1) ** (k // 2), z + 0.065 - 0.042 * k)
        parts.append(Primitive(f"{name}_{k}", "sphere", (radius,), at, (0.0, 0.0, 0.0), colour))
    return parts


def _rod(name: str, a: Vec3, b: Vec3, radius: float, rgba: Rgba) -> Primitive:
    """A cylinder from one point to another [m]."""
    dx, dy, dz = (float(q - p) for p, q in zip(a, b, strict=True))
    flat = hypot(dx, dy)
    middle = tuple(float(0.5 * (p + q)) for p, q in zip(a, b, strict=True))
    rpy = (0.0, atan2(flat, dz), atan2(dy, dx) if flat > 0.0 else 0.0)
    return Primitive(name, "cylinder", (radius, hypot(flat, dz)), (middle[0], middle[1], middle[2]), rpy, rgba)
