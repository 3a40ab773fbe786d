"""PyBullet's distances in the collision world: many spheres, moving tools, self contacts, refusals."""

from __future__ import annotations

import numpy as np
import pytest

from robot_sim.arms.rb03 import TOOL_JOINTS, grape_arm, grape_model, tool_values
from robot_sim.arms.urdf_writer import write_urdf
from robot_sim.collision import MOST_IN_COMPOUND, CollisionWorld
from robot_sim.errors import RobotError
from robot_sim.planner import box, sphere
from robot_sim.studies.grape_plan import level_pose

ARM = grape_arm()
URDF = write_urdf(grape_model(ARM))


def gripping(world: CollisionWorld, opening_m: float) -> np.ndarray:
    """Put the gripping point at a known place with the fingers at an opening; returns that place."""
    place = np.array([0.5, 0.0, 0.05])
    q = ARM.inverse(level_pose(place, 0.0)).nearest(np.zeros(6))
    assert q is not None
    world.set_joints({j.name: v for j, v in zip(ARM.chain.joints, q, strict=True)})
    world.set_joints(dict(zip(TOOL_JOINTS, tool_values(opening_m, 0.0, 0.0), strict=True)))
    return place


def test_fingers_meet_a_ball_exactly_when_they_should() -> None:
    with CollisionWorld(URDF) as world:
        place = gripping(world, 0.05)
        world.add_solid("ball", sphere(place, 0.015))
        near = {c.link: c.distance_m for c in world.contacts(0.03)}
        assert near["finger_left"] == pytest.approx(0.01, abs=1e-4)
        assert near["finger_right"] == pytest.approx(0.01, abs=1e-4)
        assert not world.contacts(0.0)
        gripping(world, 0.026)
        assert {c.link for c in world.contacts(0.0)} >= {"finger_left", "finger_right"}


def test_every_one_of_many_spheres_counts() -> None:
    count = 3 * MOST_IN_COMPOUND + 5
    with CollisionWorld(URDF) as world:
        place = gripping(world, 0.06)
        far = place + np.array([0.0, 0.0, 1.0])
        for k in range(count):
            centres = np.repeat(far[None], count, axis=0)
            centres[k] = place
            world.add_spheres(f"many{k}", centres, np.full(count, 0.035))
            assert {c.link for c in world.contacts(0.0, [f"many{k}"])} >= {"finger_left", "finger_right"}
            world.remove_body(f"many{k}")
        assert world.bodies == ()


def test_arm_that_reaches_into_its_own_pedestal_is_seen() -> None:
    with CollisionWorld(URDF) as world:
        gripping(world, 0.03)
        assert not world.self_contacts([("palm", "base_link")])
        world.set_joints({"joint2": 1.2, "joint3": 1.6, "joint5": 1.5})
        assert any(world.self_contacts([("palm", "base_link"), ("palm", "link1"), ("palm", "link2")], 0.05))


def test_wrong_calls_raise() -> None:
    with CollisionWorld(URDF) as world:
        world.add_solid("crate", box((2.0, 0, 0), (0.1, 0.1, 0.1)))
        with pytest.raises(RobotError, match="already"):
            world.add_solid("crate", sphere((2.0, 0, 0), 0.1))
        with pytest.raises(RobotError, match="no joint"):
            world.set_joints({"joint9": 0.0})
        with pytest.raises(RobotError, match="no link"):
            world.link_pose("hand")
    with pytest.raises(RobotError, match="PyBullet"):
        CollisionWorld("<robot name='x'>")
