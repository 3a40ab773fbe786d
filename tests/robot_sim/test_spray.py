"""Spraying: droplets land on the leaf in front, leaves get wet as Poisson coverage has it, tanks empty."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robot_sim.commands import ArmTarget, Liquid, RobotCommand
from robot_sim.config import RobotConfig, SprayConfig
from robot_sim.primitives import Primitive
from robot_sim.reasons import RobotReason
from robot_sim.spray import canopy, cone, coverage, first_leaf, fresh, spray, wet_share
from robot_sim.state import RobotState
from robot_sim.world import World

FRAME_S = 1.0 / 30.0
CONFIG = SprayConfig(cone_rad=0.60)
"""A narrow cone, so that one leaf takes all of it."""
GREEN = (0.1, 0.5, 0.1, 1.0)


def leaf(name: str, size: float, z: float, x: float = 0.0) -> Primitive:
    return Primitive(name, "box", (size, size, 0.004), (x, 0.0, z), (0.0, 0.0, 0.3), GREEN)


def test_a_cone_is_full_and_even_over_a_plane_across_it() -> None:
    rays = cone(20_000, 0.9, np.random.default_rng(0))
    assert np.linalg.norm(rays, axis=1) == pytest.approx(1.0)
    radius = np.linalg.norm(rays[:, :2], axis=1) / -rays[:, 2]
    assert radius.max() <= math.tan(0.9) + 1e-9
    # half the circle's area takes half of the rays
    assert (radius < math.tan(0.9) / math.sqrt(2)).mean() == pytest.approx(0.5, abs=0.02)


def test_what_a_parcel_wets_follows_from_its_droplets() -> None:
    config = SprayConfig(droplet_um=200.0, spread_factor=2.0, flow_l_s=0.02, parcels_1_s=1000.0)
    droplet_l = math.pi / 6 * 200e-6**3 * 1e3
    spot_m2 = math.pi / 4 * (2 * 200e-6) ** 2
    assert config.parcel_m2 == pytest.approx(0.02 / 1000 / droplet_l * spot_m2)


def test_the_leaf_in_front_shades_the_one_behind() -> None:
    leaves = canopy([leaf("behind", 0.5, -0.8), leaf("front", 0.5, -0.4), leaf("aside", 0.2, -0.4, x=1.0)])
    straight = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    assert first_leaf(leaves, np.zeros(3), straight, 1.2).tolist() == [1, -1, -1]
    assert first_leaf(leaves, np.zeros(3), straight, 0.3).tolist() == [-1, -1, -1]
    assert first_leaf(canopy([]), np.zeros(3), straight, 1.2).tolist() == [-1, -1, -1]


def test_wet_share_follows_the_number_of_parcels() -> None:
    leaves = canopy([leaf("only", 0.4, -0.3)])
    state = fresh(leaves, CONFIG)
    rng = np.random.default_rng(1)
    for _ in range(30):
        state = spray(state, leaves, Liquid.NUTRIENT, np.zeros(3), np.eye(3), FRAME_S, rng, CONFIG)
    hits = state.hits[0]
    # the cone is 41 cm wide there, and the leaf 40 with its corners turned: nearly all hit
    assert hits[1] + state.missed[1] == pytest.approx(CONFIG.parcels_1_s, abs=15)
    assert state.missed[1] < 60 and hits[[0, 2]].tolist() == [0, 0]
    expected = 1 - math.exp(-hits[1] * CONFIG.parcel_m2 / 0.16)
    assert wet_share(state, leaves, CONFIG)[0] == pytest.approx([0.0, expected, 0.0])
    everywhere = ((-1, -1, -1), (1, 1, 1))
    assert coverage(state, leaves, Liquid.NUTRIENT, *everywhere, CONFIG) == pytest.approx(expected)
    assert coverage(state, leaves, Liquid.NUTRIENT, (2, 2, 2), (3, 3, 3), CONFIG) == 0.0
    assert state.tank_l == pytest.approx((CONFIG.tank_l, CONFIG.tank_l - CONFIG.flow_l_s, CONFIG.tank_l))


def test_an_empty_tank_gives_nothing() -> None:
    config = SprayConfig(tank_l=0.01, flow_l_s=0.02)
    leaves = canopy([leaf("only", 0.4, -0.3)])
    state = fresh(leaves, config)
    rng = np.random.default_rng(1)
    for _ in range(60):
        state = spray(state, leaves, Liquid.WATER, np.zeros(3), np.eye(3), FRAME_S, rng, config)
    assert state.tank_l[0] == 0.0
    assert state.hits[0, 0] + state.missed[0] == pytest.approx(0.5 * config.parcels_1_s, abs=10)


def run(world: World, seconds: float, **command: object) -> RobotState:
    state = world.state()
    for _ in range(round(seconds / FRAME_S)):
        state = world.step(RobotCommand(t_ns=0, **command), FRAME_S)  # type: ignore[arg-type]
    return state


def test_the_rear_arm_sprays_the_cucumbers_after_a_half_turn() -> None:
    world = World(RobotConfig(spray=SprayConfig(tank_l=0.20)), seed=1)
    run(world, 2.2, disc_rad=math.pi, rear_arm=ArmTarget(0, 0, 90))
    run(world, 1.0, disc_rad=math.pi, rear_arm=ArmTarget(0, 0, 90))
    # leaves in reach, 0.8 m of the row
    row = world.config.greenhouse.row_offset_m
    front = ((-0.25, row - 0.3, 0.85), (0.25, row + 0.3, 1.25))
    assert world.coverage(Liquid.PESTICIDE, *front) == 0.0
    dry = run(world, 0.5, spray_on=False, liquid=Liquid.PESTICIDE)
    assert dry.tank_l["pesticide"] == 0.20
    for elbow in (90, 110, 130, 110):
        state = run(world, 1.0, spray_on=True, liquid=Liquid.PESTICIDE, rear_arm=ArmTarget(0, 0, elbow))
    assert state.spray_on and state.liquid is Liquid.PESTICIDE
    assert state.tank_l == pytest.approx({"water": 0.20, "nutrient": 0.20, "pesticide": 0.04}, abs=1e-6)
    wet = world.coverage(Liquid.PESTICIDE, *front)
    assert wet > 0.3
    assert world.coverage(Liquid.WATER, *front) == 0.0
    leaves = world.wet_leaves()
    assert leaves and all("_leaf" in name for name in leaves)
    assert all(water == nutrient == 0.0 < pesticide <= 1.0 for water, nutrient, pesticide in leaves.values())
    assert world.coverage(Liquid.PESTICIDE, (-3, -2, 0), (4, -0.3, 3)) == 0.0
    assert 0.0 < world.overspray(Liquid.PESTICIDE) < 1.0
    empty = run(world, 2.0, spray_on=True, liquid=Liquid.PESTICIDE)
    assert not empty.spray_on and RobotReason.TANK_EMPTY in empty.reasons
    assert run(world, 0.1, spray_on=True, liquid=Liquid.WATER).spray_on
    world.close()


def test_a_square_metre_is_wet_after_a_sweep_in_the_operators_steps() -> None:
    world = World(seed=0)
    run(world, 3.5, disc_rad=math.pi)
    run(world, 0.8, rear_arm=ArmTarget(0, 0, 140))
    row = world.config.greenhouse.row_offset_m
    window = ((-0.5, row - 0.45, 0.75), (0.5, row + 0.45, 1.75))
    assert world.coverage(Liquid.WATER, *window) == 0.0
    # the forearm rises, then the upper arm in steps of 15 degrees: 6 s
    sweep = [(0, 140 - 10 * k) for k in range(6)] + [(15, 90), (30, 90), (45, 90), (30, 90), (15, 90), (0, 90)]
    for c1, elbow in sweep:
        run(world, 0.5, rear_arm=ArmTarget(c1, 0, elbow), spray_on=True)
    assert world.coverage(Liquid.WATER, *window) >= 0.9
    world.close()


def test_the_boxes_of_one_leaf_count_together() -> None:
    pair = [
        leaf("plant_leaf_0", 0.2, -0.4),
        leaf("plant_leaf_0_lobe", 0.15, -0.39),
        leaf("plant_leaf_1", 0.2, -0.4, 1.0),
    ]
    leaves = canopy(pair)
    assert leaves.names == ("plant_leaf_0", "plant_leaf_1")
    assert leaves.area_m2 == pytest.approx([0.75 * (0.04 + 0.0225), 0.04])
    rays = np.array([[0.0, 0.0, -1.0], [0.09, 0.0, -0.4]])
    assert first_leaf(leaves, np.zeros(3), rays, 1.2).tolist() == [0, 0]
