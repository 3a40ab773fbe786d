"""URDF text from a chain, solids on its links and a few tool links: one truth for kinematics, physics and viewers."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from robot_sim.errors import RobotError
from robot_sim.kinematics.chain import Chain
from robot_sim.kinematics.transforms import FloatArray, rotation_between, to_rpy, translation
from robot_sim.planner.shapes import Box, Cylinder, Solid, Sphere

Rgba = tuple[float, float, float, float]
GREY: Rgba = (0.55, 0.58, 0.62, 1.0)
ORANGE: Rgba = (0.90, 0.55, 0.15, 1.0)
STEEL: Rgba = (0.75, 0.77, 0.80, 1.0)


@dataclass(frozen=True, slots=True, eq=False)
class ToolLink:
    """A link behind the arm's last one. kind: fixed, revolute or prismatic about or along its own z."""

    name: str
    parent: str
    T_parent_joint: FloatArray
    solids: tuple[Solid, ...]
    kind: str = "fixed"
    lower: float = 0.0
    upper: float = 0.0
    speed: float = 1.0
    color: Rgba = STEEL


@dataclass(frozen=True, slots=True, eq=False)
class ArmModel:
    """What the writer needs: link solids by joint index (-1 is the base), tool links, colour."""

    chain: Chain
    solids: Mapping[int, Sequence[Solid]]
    tools: tuple[ToolLink, ...] = field(default=())
    color: Rgba = GREY

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of all moving joints: the arm's, then the tools'."""
        return tuple(j.name for j in self.chain.joints) + tuple(
            f"{t.name}_joint" for t in self.tools if t.kind != "fixed"
        )


def limb(start: FloatArray, end: FloatArray, radius_m: float) -> Cylinder:
    """Cylinder from point start (3,) to end (3,) of a link's frame."""
    axis = np.asarray(end) - np.asarray(start)
    length = float(np.linalg.norm(axis))
    if length < 1e-6:
        raise RobotError("a limb needs two different points")
    T = translation(*((np.asarray(start) + np.asarray(end)) / 2)) @ rotation_between((0, 0, 1), axis)
    return Cylinder(T, radius_m, length)


def limbs_of(chain: Chain, radius_m: float) -> dict[int, list[Solid]]:
    """A limb along every link longer than its radius; what is before the first joint belongs to -1."""
    solids: dict[int, list[Solid]] = {}
    for i, F in enumerate(chain.fixed[:-1]):
        if np.linalg.norm(F[:3, 3]) > radius_m:
            solids.setdefault(i - 1, []).append(limb(np.zeros(3), F[:3, 3], radius_m))
    return solids


def _triple(values: Sequence[float] | FloatArray) -> str:
    return " ".join(repr(float(v)) for v in values)


def _origin(parent: ET.Element, T: FloatArray) -> None:
    ET.SubElement(parent, "origin", xyz=_triple(T[:3, 3]), rpy=_triple(to_rpy(T)))


def _geometry(parent: ET.Element, solid: Solid) -> None:
    _origin(parent, solid.T)
    geometry = ET.SubElement(parent, "geometry")
    if isinstance(solid, Box):
        ET.SubElement(geometry, "box", size=_triple([2 * h for h in solid.half_m]))
    elif isinstance(solid, Cylinder):
        ET.SubElement(geometry, "cylinder", radius=repr(solid.radius_m), length=repr(solid.height_m))
    elif isinstance(solid, Sphere):
        ET.SubElement(geometry, "sphere", radius=repr(solid.radius_m))
    else:
        raise RobotError(f"URDF has no shape for {type(solid).__name__}; use Box, Cylinder or Sphere")


def _link(robot: ET.Element, name: str, solids: Sequence[Solid], color: Rgba) -> None:
    link = ET.SubElement(robot, "link", name=name)
    # the studies move the arm by its joints, not by forces: any sound inertia will do
    inertial = ET.SubElement(link, "inertial")
    _origin(inertial, solids[0].T if solids else np.eye(4))
    ET.SubElement(inertial, "mass", value="1.0")
    ET.SubElement(inertial, "inertia", ixx="0.01", iyy="0.01", izz="0.01", ixy="0", ixz="0", iyz="0")
    for solid in solids:
        visual = ET.SubElement(link, "visual")
        _geometry(visual, solid)
        material = ET.SubElement(visual, "material", name=f"{name}_paint")
        ET.SubElement(material, "color", rgba=_triple(color))
        _geometry(ET.SubElement(link, "collision"), solid)


def _joint(
    robot: ET.Element, name: str, kind: str, ends: tuple[str, str], T: FloatArray, limits: tuple[float, float, float]
) -> None:
    joint = ET.SubElement(robot, "joint", name=name, type=kind)
    ET.SubElement(joint, "parent", link=ends[0])
    ET.SubElement(joint, "child", link=ends[1])
    _origin(joint, T)
    if kind != "fixed":
        ET.SubElement(joint, "axis", xyz="0 0 1")
        lower, upper, speed = (repr(float(v)) for v in limits)
        ET.SubElement(joint, "limit", lower=lower, upper=upper, velocity=speed, effort="100")


def write_urdf(model: ArmModel) -> str:
    """URDF of the arm: links base_link, link1..linkN, tool0 (the chain's tool frame), then the tool links."""
    chain = model.chain
    robot = ET.Element("robot", name=chain.name)
    _link(robot, "base_link", model.solids.get(-1, ()), model.color)
    parent = "base_link"
    for i, j in enumerate(chain.joints):
        child = f"link{i + 1}"
        _link(robot, child, model.solids.get(i, ()), model.color)
        speed = j.speed if np.isfinite(j.speed) else 10.0
        _joint(robot, j.name, j.kind, (parent, child), chain.fixed[i], (j.lower, j.upper, speed))
        parent = child
    _link(robot, "tool0", (), model.color)
    _joint(robot, "tool0_fixed", "fixed", (parent, "tool0"), chain.fixed[-1], (0, 0, 0))
    for t in model.tools:
        _link(robot, t.name, t.solids, t.color)
        _joint(robot, f"{t.name}_joint", t.kind, (t.parent, t.name), t.T_parent_joint, (t.lower, t.upper, t.speed))
    ET.indent(robot)
    return ET.tostring(robot, encoding="unicode")
