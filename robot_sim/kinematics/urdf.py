"""A chain from a URDF: the joints between a base link and a tip link, whatever their axes."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from robot_sim.errors import RobotError
from robot_sim.kinematics.chain import Chain, Joint, JointKind
from robot_sim.kinematics.transforms import FloatArray, inverse_pose, rotation_between, rpy, translation

_MOVING: dict[str, JointKind] = {"revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic"}


@dataclass(frozen=True, slots=True, eq=False)
class _UrdfJoint:
    name: str
    kind: str
    parent: str
    child: str
    origin: FloatArray
    axis: FloatArray
    lower: float
    upper: float
    speed: float


def _numbers(text: str, count: int, what: str) -> FloatArray:
    try:
        values = np.array([float(v) for v in text.split()])
    except ValueError:
        raise RobotError(f"URDF: {what} holds '{text}', which is not {count} numbers") from None
    if len(values) != count or not np.isfinite(values).all():
        raise RobotError(f"URDF: {what} holds '{text}', which is not {count} finite numbers")
    return values


def _joint(element: ET.Element) -> _UrdfJoint:
    name, kind = element.get("name", ""), element.get("type", "")
    ends = {tag: element.find(tag) for tag in ("parent", "child")}
    links = {tag: (e.get("link") if e is not None else None) for tag, e in ends.items()}
    if not (links["parent"] and links["child"]):
        raise RobotError(f"URDF: joint '{name}' lacks its parent or child link")
    origin = element.find("origin")
    T = np.eye(4)
    if origin is not None:
        xyz = _numbers(origin.get("xyz", "0 0 0"), 3, f"origin xyz of joint '{name}'")
        turn = _numbers(origin.get("rpy", "0 0 0"), 3, f"origin rpy of joint '{name}'")
        T = translation(*xyz) @ rpy(*turn)
    axis_element = element.find("axis")
    axis = np.array([1.0, 0, 0])
    if axis_element is not None:
        axis = _numbers(axis_element.get("xyz", "1 0 0"), 3, f"axis of joint '{name}'")
    if kind in _MOVING and np.linalg.norm(axis) < 1e-9:
        raise RobotError(f"URDF: joint '{name}' has a zero axis")
    limit = element.find("limit")
    lower, upper, speed = -np.inf, np.inf, np.inf
    if limit is not None:
        speed = _numbers(limit.get("velocity", "inf").replace("inf", "1e308"), 1, f"velocity of joint '{name}'")[0]
        if kind != "continuous":
            lower = _numbers(limit.get("lower", "0"), 1, f"lower limit of joint '{name}'")[0]
            upper = _numbers(limit.get("upper", "0"), 1, f"upper limit of joint '{name}'")[0]
    return _UrdfJoint(name, kind, str(links["parent"]), str(links["child"]), T, axis, lower, upper, speed)


def _path(joints: list[_UrdfJoint], base: str, tip: str) -> list[_UrdfJoint]:
    """The joints from base to tip, in order."""
    by_child = {j.child: j for j in joints}
    links = sorted({j.parent for j in joints} | set(by_child))
    for wanted in (base, tip):
        if wanted not in links:
            raise RobotError(f"URDF: no link '{wanted}'; there are: {', '.join(links)}")
    path: list[_UrdfJoint] = []
    link = tip
    while link != base:
        if link not in by_child or len(path) > len(joints):
            raise RobotError(f"URDF: link '{tip}' does not hang below '{base}'")
        path.append(by_child[link])
        link = by_child[link].parent
    return path[::-1]


def _ends(joints: list[_UrdfJoint]) -> tuple[str, str]:
    """Root link and the only leaf link; raises when a tip must be named."""
    parents, children = {j.parent for j in joints}, {j.child for j in joints}
    roots, leaves = sorted(parents - children), sorted(children - parents)
    if len(roots) != 1:
        raise RobotError(f"URDF: expected one root link, found {len(roots)}: {', '.join(roots)}")
    if len(leaves) != 1:
        raise RobotError(f"URDF: the robot branches; name the tip link, one of: {', '.join(leaves)}")
    return roots[0], leaves[0]


def chain_from_urdf(urdf: str | Path, base: str | None = None, tip: str | None = None) -> Chain:
    """Chain between two links of a URDF, given as a path or as XML text (starts with ``<``).

    base defaults to the root link, tip to the only leaf. Fixed joints are merged. Joint values keep the URDF's meaning.
    Raises RobotError for XML that is broken, links that do not exist, and joints of other kinds (floating, planar).
    """
    text = str(urdf)
    if not text.lstrip().startswith("<"):
        path = Path(text)
        if not path.is_file():
            raise RobotError(f"URDF file not found: {path}; give a path to a .urdf file or the XML itself")
        text = path.read_text(encoding="utf-8")
    try:
        root = ET.fromstring(text)
    except ET.ParseError as error:
        raise RobotError(f"URDF: not well-formed XML ({error})") from None
    joints = [_joint(e) for e in root.findall("joint")]
    if root.tag != "robot" or not joints:
        raise RobotError("URDF: expected a <robot> with at least one <joint>")
    if base is None or tip is None:
        children = {j.child for j in joints}
        base = base or next((j.parent for j in joints if j.parent not in children), joints[0].parent)
        tip = tip or _ends(joints)[1]
    moving: list[Joint] = []
    fixed: list[FloatArray] = []
    behind = np.eye(4)
    for j in _path(joints, base, tip):
        behind = behind @ j.origin
        if j.kind == "fixed":
            continue
        if j.kind not in _MOVING:
            raise RobotError(f"URDF: joint '{j.name}' is '{j.kind}'; a chain takes fixed, {', '.join(_MOVING)}")
        align = rotation_between((0, 0, 1), j.axis)
        fixed.append(behind @ align)
        behind = inverse_pose(align)
        moving.append(Joint(j.name, _MOVING[j.kind], j.lower, j.upper, j.speed))
    if not moving:
        raise RobotError(f"URDF: no moving joint between '{base}' and '{tip}'")
    fixed.append(behind)
    return Chain(root.get("name", "robot"), tuple(moving), np.array(fixed))
