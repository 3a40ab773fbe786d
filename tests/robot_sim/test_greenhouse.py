"""The greenhouse row: the same seed gives the same crop, light enough to draw, with room for the robot."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robot_sim.config import GreenhouseConfig, RobotConfig
from robot_sim.greenhouse import greenhouse, solid
from robot_sim.primitives import Primitive, rotation, rpy_of
from robot_sim.world.meshes import merge, tessellate

CONFIG = GreenhouseConfig()
TRIANGLES = {"box": 12, "cylinder": 32, "sphere": 80}


def test_the_seed_decides_the_crop_and_nothing_else() -> None:
    assert greenhouse(CONFIG, 3) == greenhouse(CONFIG, 3)
    assert greenhouse(CONFIG, 3) != greenhouse(CONFIG, 4)
    assert solid(greenhouse(CONFIG, 3).parts) == solid(greenhouse(CONFIG, 4).parts)


def test_names_are_unique_and_a_browser_can_draw_it() -> None:
    parts = greenhouse(CONFIG).primitives
    assert len({p.name for p in parts}) == len(parts)
    assert sum(TRIANGLES[p.kind] for p in parts) <= 12_000
    assert all(isinstance(v, float) for p in parts for v in (*p.xyz_m, *p.rpy_rad, *p.size_m))


def test_fruit_hangs_in_reach_and_nothing_solid_stands_in_the_aisle() -> None:
    row = greenhouse(CONFIG)
    robot = RobotConfig()
    cucumbers = [f for f in row.fruits if f.crop == "cucumber"]
    assert len(cucumbers) >= 10
    reach = robot.arm.forward_offset_m + robot.arm.upper_m + robot.arm.forearm_m + 0.13
    assert all(0.5 < p.xyz_m[1] < reach for p in cucumbers)
    turning_circle = math.hypot(0.5 * robot.chassis.length_m, 0.5 * robot.chassis.width_m)
    for p in solid(row.parts):
        assert abs(p.xyz_m[1]) - 0.5 * p.size_m[1] > turning_circle, p.name


@pytest.mark.parametrize(
    ("part", "area"),
    [
        (Primitive("b", "box", (1.0, 2.0, 3.0), (1, 2, 3), (0.3, -0.4, 2.0), (1, 0, 0, 1)), 22.0),
        # an 8-sided prism and an 8 x 6 ball are a little smaller than the round bodies
        (Primitive("c", "cylinder", (1.0, 2.0), (0, 0, 1), (0.0, 1.0, 0.5), (1, 0, 0, 1)), 0.93 * 6 * math.pi),
        (Primitive("s", "sphere", (1.0,), (0, 0, 0), (0, 0, 0), (1, 0, 0, 1)), 0.917 * 4 * math.pi),
    ],
)
def test_meshes_are_closed_and_face_outwards(part: Primitive, area: float) -> None:
    v, n, t = tessellate(part)
    a, b, c = v[t[:, 0]], v[t[:, 1]], v[t[:, 2]]
    cross = np.cross(b - a, c - a)
    assert 0.5 * np.linalg.norm(cross, axis=1).sum() == pytest.approx(area, rel=0.03)
    # a closed surface: the area vectors cancel out; outward: towards the normals
    assert np.abs(cross.sum(axis=0)).max() < 1e-9
    assert (np.einsum("ij,ij->i", cross, n[t].sum(axis=1)) > 0).all()
    assert (np.einsum("ij,ij->i", cross, (a + b + c) / 3 - np.array(part.xyz_m)) > 0).all()


def test_merging_keeps_every_triangle() -> None:
    parts = greenhouse(CONFIG).parts
    meshes = merge(parts)
    assert sum(len(m.triangles) for m in meshes) == sum(len(tessellate(p)[2]) for p in parts)
    assert all(m.triangles.max() < len(m.vertices_m) for m in meshes)
    assert len(meshes) == len({p.rgba for p in parts})


def test_roll_pitch_yaw_round_trip() -> None:
    rpy = (0.4, -0.9, 2.5)
    assert rpy_of(rotation(rpy)) == pytest.approx(rpy)


def test_fruit_hangs_apart_and_weighs_what_it_should() -> None:
    for seed in range(4):
        fruits = greenhouse(CONFIG, seed).fruits
        for i, a in enumerate(fruits):
            for b in fruits[:i]:
                dx, dy, _ = (p - q for p, q in zip(a.xyz_m, b.xyz_m, strict=True))
                assert math.hypot(dx, dy) > 0.05 or abs(a.xyz_m[2] - b.xyz_m[2]) > a.top_m + b.top_m, (a.name, b.name)
        assert all(0.08 < f.mass_kg < 0.30 for f in fruits if f.crop == "cucumber")
