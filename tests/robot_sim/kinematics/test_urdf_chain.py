"""Chains from URDF: PyBullet's own forward kinematics agrees on every arm; broken files get one clear line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from robot_sim.arms.plantlet import plantlet_arm, plantlet_model
from robot_sim.arms.rb03 import grape_arm, grape_model
from robot_sim.arms.tomato import tomato_arm, tomato_model
from robot_sim.arms.urdf_writer import ArmModel, write_urdf
from robot_sim.collision import CollisionWorld
from robot_sim.errors import RobotError
from robot_sim.kinematics import chain_from_urdf

MODELS = {
    m.chain.name: m for m in (grape_model(grape_arm()), plantlet_model(plantlet_arm()), tomato_model(tomato_arm()))
}


@pytest.mark.parametrize("name", MODELS)
def test_our_forward_kinematics_is_pybullets(name: str) -> None:
    model: ArmModel = MODELS[name]
    text = write_urdf(model)
    chain = chain_from_urdf(text, tip="tool0")
    rng = np.random.default_rng(1)
    with CollisionWorld(text) as world:
        for q in rng.uniform(model.chain.lower, model.chain.upper, (40, model.chain.n)):
            world.set_joints({j.name: v for j, v in zip(model.chain.joints, q, strict=True)})
            theirs = world.link_pose("tool0")
            ours = model.chain.forward(q)
            np.testing.assert_allclose(ours[:3, 3], theirs[:3, 3], atol=1e-6)
            np.testing.assert_allclose(ours[:3, :3], theirs[:3, :3], atol=2e-6)
            np.testing.assert_allclose(chain.forward(q), ours, atol=1e-12)
            for i, T in enumerate(model.chain.frames(q)[:-1], start=1):
                np.testing.assert_allclose(T[:3, 3], world.link_pose(f"link{i}")[:3, 3], atol=1e-6)


ODD = """<robot name="odd"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
<joint name="slide" type="prismatic"><parent link="a"/><child link="b"/><origin xyz="0.1 0 0.2" rpy="0.3 -0.4 0.5"/>
<axis xyz="0 1 0"/><limit lower="-0.2" upper="0.3" velocity="0.5" effort="1"/></joint>
<joint name="turn" type="continuous"><parent link="b"/><child link="c"/><origin xyz="0 0.3 0"/>
<axis xyz="-1 2 0.5"/></joint>
<joint name="hinge" type="revolute"><parent link="c"/><child link="d"/><origin xyz="0.2 0 0" rpy="1 0 0"/>
<axis xyz="0 0 -1"/><limit lower="-1" upper="2" velocity="3" effort="1"/></joint></robot>"""


def test_any_axis_and_kind_of_joint(tmp_path: Path) -> None:
    path = tmp_path / "odd.urdf"
    path.write_text(ODD, encoding="utf-8")
    chain = chain_from_urdf(path)
    assert [j.kind for j in chain.joints] == ["prismatic", "revolute", "revolute"]
    assert chain.joints[1].lower == -np.inf and chain.joints[2].speed == 3.0
    rng = np.random.default_rng(2)
    with CollisionWorld(ODD) as world:
        for _ in range(20):
            q = rng.uniform((-0.2, -3, -1), (0.3, 3, 2))
            world.set_joints(dict(zip(("slide", "turn", "hinge"), q, strict=True)))
            np.testing.assert_allclose(chain.forward(q)[:3, 3], world.link_pose("d")[:3, 3], atol=1e-6)
    assert chain_from_urdf(ODD, base="b", tip="c").n == 1


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("<robot", "well-formed"),
        ("<robot name='x'/>", "at least one <joint>"),
        (ODD.replace("-1 2 0.5", "0 0 0"), "zero axis"),
        (ODD.replace("continuous", "planar"), "planar"),
        (ODD.replace("0.1 0 0.2", "0.1 zero 0.2"), "not 3 numbers"),
        ("/nowhere/arm.urdf", "not found"),
    ],
)
def test_broken_files_get_one_line(text: str, says: str) -> None:
    with pytest.raises(RobotError, match=says) as caught:
        chain_from_urdf(text)
    assert "\n" not in str(caught.value)
    with pytest.raises(RobotError, match="there are: a, b, c, d"):
        chain_from_urdf(ODD, tip="gripper")
