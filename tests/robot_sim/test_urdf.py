"""The generated URDF: a tree of primitives with plausible masses, whose arms follow robot_sim.arm_angles."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pybullet
import pytest
from pybullet_utils.bullet_client import BulletClient

from robot_sim.actuators import JOINTS, WHEELS, axes
from robot_sim.arm_angles import forearm_direction, joint_rad, upper_arm_direction
from robot_sim.commands import ARM_NAMES, ArmTarget
from robot_sim.config import RobotConfig
from robot_sim.reach import hand_in_base
from robot_sim.urdf import robot_urdf

CONFIG = RobotConfig()
ROOT = ET.fromstring(robot_urdf(CONFIG))
# what three.js makes of a URDF primitive (urdf-loader: 30 segments)
TRIANGLES = {"box": 12, "cylinder": 120, "sphere": 1740}


def test_links_and_joints_form_one_tree() -> None:
    links = [link.get("name") for link in ROOT.findall("link")]
    children = [joint.find("child").get("link") for joint in ROOT.findall("joint")]
    assert len(set(links)) == len(links) and len(set(children)) == len(children)
    assert set(links) - set(children) == {"base_link"}
    assert {joint.find("parent").get("link") for joint in ROOT.findall("joint")} <= set(links)


def test_every_driven_joint_is_there_with_the_limits_of_the_configuration() -> None:
    joints = {joint.get("name"): joint for joint in ROOT.findall("joint")}
    assert set(WHEELS) <= set(joints)
    for axis in axes(CONFIG):
        limit = joints[axis.name].find("limit")
        assert float(limit.get("lower")) == pytest.approx(axis.limits.lower, abs=1e-5)
        assert float(limit.get("upper")) == pytest.approx(axis.limits.upper, abs=1e-5)
        assert float(limit.get("velocity")) == pytest.approx(axis.limits.speed, abs=1e-5)
    assert len(JOINTS) == len(axes(CONFIG))


def test_inertias_are_those_of_real_bodies() -> None:
    total = 0.0
    for link in ROOT.findall("link"):
        mass = float(link.find("inertial/mass").get("value"))
        i = link.find("inertial/inertia")
        x, y, z = (float(i.get(k)) for k in ("ixx", "iyy", "izz"))
        assert mass > 0 and min(x, y, z) > 0
        # printed with six digits
        assert x + y >= z * (1 - 1e-5) and y + z >= x * (1 - 1e-5) and z + x >= y * (1 - 1e-5), link.get("name")
        total += mass
    assert 60 < total < 150


def test_a_browser_can_draw_it() -> None:
    shapes = [shape for geometry in ROOT.findall("link/visual/geometry") for shape in geometry]
    assert {shape.tag for shape in shapes} <= set(TRIANGLES)
    assert sum(TRIANGLES[shape.tag] for shape in shapes) <= 12_000
    named = {material.get("name") for material in ROOT.findall("material")}
    assert {m.get("name") for m in ROOT.findall("link/visual/material")} <= named


@pytest.mark.parametrize("arm", ARM_NAMES)
@pytest.mark.parametrize("target", [ArmTarget(0, 0, 180), ArmTarget(40, 25, 110), ArmTarget(-10, 80, 95)])
def test_the_arms_point_where_the_angles_say(tmp_path: Path, arm: str, target: ArmTarget) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text(robot_urdf(CONFIG))
    client = BulletClient(pybullet.DIRECT)
    robot = client.loadURDF(str(path))
    infos = [client.getJointInfo(robot, i) for i in range(client.getNumJoints(robot))]
    index = {info[1].decode(): info[0] for info in infos}
    link = {info[12].decode(): info[0] for info in infos}
    for name, q in joint_rad(target, arm).items():
        client.resetJointState(robot, index[name], q)

    def origin(name: str) -> np.ndarray:
        return np.array(client.getLinkState(robot, link[name], computeForwardKinematics=True)[4])

    elbow = origin(f"{arm}_forearm")
    upper = (elbow - origin(f"{arm}_upper_arm")) / CONFIG.arm.upper_m
    tool = origin(f"{arm}_tool")
    fore = (tool - elbow) / CONFIG.arm.forearm_m
    client.disconnect()
    # at disc zero the chest faces the world's y; the rear arm faces the other way
    facing = np.array([0.0, 1.0, 0.0]) * (-1.0 if arm == "rear" else 1.0)
    inward = {"right": 1.0, "left": -1.0, "rear": 0.0}[arm] * CONFIG.arm.toe_in_rad
    facing = math.cos(inward) * facing + math.sin(inward) * np.cross([0.0, 0.0, 1.0], facing)
    left = np.cross([0.0, 0.0, 1.0], facing)
    outward = left if arm == "left" else -left
    axes_of_arm = np.stack([facing, outward, [0.0, 0.0, 1.0]])
    assert axes_of_arm @ upper == pytest.approx(upper_arm_direction(target.c1_deg, target.c2_deg), abs=1e-5)
    here = hand_in_base(arm, target, 0.0, 0.0, 0.0, CONFIG)
    assert here == pytest.approx(tool, abs=1e-5)
    assert axes_of_arm @ fore == pytest.approx(forearm_direction(target), abs=1e-5)
