"""The robot's arms and trunk as capsules, taken from the collision shapes of its own URDF description.

A capsule is a segment with a radius: distances between them are cheap, and none of them is smaller than its shape by
more than the rounding of edges.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np
import numpy.typing as npt

from robot_sim.arm_angles import arm_joint_names
from robot_sim.commands import ARM_NAMES
from robot_sim.config import RobotConfig
from robot_sim.derived import derived
from robot_sim.kinematics.transforms import rpy, translation
from robot_sim.urdf import robot_parts
from robot_sim.urdf_parts import Joint, Link, Shape

F64 = npt.NDArray[np.float64]
I64 = npt.NDArray[np.int64]
# a capsule's end stands out of a flat one by half its radius, so that the rim is bare by a tenth of it only
LINE_SPACING_M = 0.06
"""Flat boxes are covered by parallel capsules no further apart than this; what passes between two is thinner still."""
TRUNK = "disc_link"


@dataclass(frozen=True, slots=True, eq=False)
class ArmModel:
    """Kinematics and capsules of the upper body, in the disc's axes [m]. K capsules.

    T_joint (3 arms, 3 joints, 4, 4): from the link before a joint to the joint at zero; axis (3, 3, 3): unit, in the
    joint's axes. body (K,): 3 * arm + joint that carries the capsule, -1 for the trunk. ends_m (K, 2, 3) in that
    link's axes, radius_m (K,). tip_m (3, 3): the far end of each arm's tool in its forearm's axes. lever_m (3, 3): no
    point that a joint carries is further from it, whatever the joints beyond it do.
    """

    T_joint: F64
    axis: F64
    body: I64
    ends_m: F64
    radius_m: F64
    tip_m: F64
    lever_m: F64


def lines_of(shape: Shape) -> list[tuple[F64, F64, float]]:
    """Capsules (end, end, radius) that cover a shape, in the link's axes."""
    R = np.asarray(rpy(*shape.rpy_rad))[:3, :3]
    at = np.array(shape.xyz_m)
    if shape.kind == "sphere":
        return [(at, at, shape.size_m[0])]
    if shape.kind == "cylinder" and shape.size_m[1] >= 2 * shape.size_m[0]:
        radius, length = shape.size_m
        half = R @ np.array([0.0, 0.0, 0.5 * (length - radius)])
        return [(at - half, at + half, radius)]
    if shape.kind == "cylinder":
        return _disc(shape.size_m[0], shape.size_m[1], at, R)
    order = np.argsort(shape.size_m)
    thin, middle, long = (shape.size_m[i] for i in order)
    radius = 0.5 * thin
    count = max(1, ceil((middle - thin) / LINE_SPACING_M) + (middle > 1.5 * thin))
    along = R[:, order[2]] * 0.5 * (long - radius)
    across = R[:, order[1]]
    places = np.linspace(-0.5 * middle + radius, 0.5 * middle - radius, count) if count > 1 else (0.0,)
    # out to the long edges, which a round capsule inside the box would leave bare
    outer = radius * sqrt(2.0)
    return [(at + y * across - along, at + y * across + along, outer) for y in places]


def _disc(radius_m: float, height_m: float, at: F64, R: F64) -> list[tuple[F64, F64, float]]:
    """A flat cylinder as parallel chords."""
    r = 0.5 * height_m
    reach = max(radius_m - r, 0.0)
    count = ceil(2 * reach / LINE_SPACING_M) + 1
    lines = []
    for y in np.linspace(-reach, reach, count):
        half = sqrt(max(reach**2 - y**2, 0.0))
        lines.append((at + R @ np.array([-half, y, 0.0]), at + R @ np.array([half, y, 0.0]), r))
    return lines


def _pose(joint: Joint) -> F64:
    return np.asarray(translation(*joint.xyz_m) @ rpy(*joint.rpy_rad))


@derived
def arm_model(config: RobotConfig) -> ArmModel:
    """The model of a robot. Jaws count as open; the head camera and the cutter's blade are left out."""
    parts = robot_parts(config)
    links = {p.name: p for p in parts if isinstance(p, Link)}
    joints = [p for p in parts if isinstance(p, Joint)]
    T_joint, axis = np.zeros((3, 3, 4, 4)), np.zeros((3, 3, 3))
    carried: dict[str, tuple[int, F64]] = {TRUNK: (-1, np.eye(4))}
    moving = {name: 3 * a + j for a, arm in enumerate(ARM_NAMES) for j, name in enumerate(arm_joint_names(arm))}
    for joint in joints:
        if joint.parent not in carried:
            continue
        body, T = carried[joint.parent]
        T = T @ _pose(joint)
        if joint.name in moving:
            body = moving[joint.name]
            T_joint[body // 3, body % 3], axis[body // 3, body % 3] = T, np.array(joint.axis)
            T = np.eye(4)
        elif joint.kind == "prismatic" and joint.limits is not None:
            T = T @ translation(*(np.array(joint.axis) * joint.limits.upper))
        elif joint.kind != "fixed":
            continue
        carried[joint.child] = (body, T)
    bodies, ends, radii = [], [], []
    tip_m = np.zeros((3, 3))
    for name, (body, T) in carried.items():
        if name.endswith("_shoulder"):
            continue  # sits in the trunk's own shoulder
        for shape in links[name].collisions:
            if body < 0 and shape.kind == "cylinder":
                continue  # the disc: its rim lies under the shoulders, where the arms hang
            for a, b, radius in lines_of(shape):
                a, b = T[:3, :3] @ a + T[:3, 3], T[:3, :3] @ b + T[:3, 3]
                bodies.append(body)
                ends.append((a, b))
                radii.append(radius)
                if body % 3 == 2 and body >= 0:
                    low = a if a[2] < b[2] else b
                    tip_m[body // 3] = min(tip_m[body // 3], low, key=lambda p: float(p[2]))
    carrier, ends_m, radius_m = np.array(bodies), np.array(ends), np.array(radii)
    levers = _levers(T_joint, carrier, ends_m, radius_m)
    return ArmModel(T_joint, axis, carrier, ends_m, radius_m, tip_m, levers)


def _levers(T_joint: F64, body: I64, ends_m: F64, radius_m: F64) -> F64:
    """ArmModel.lever_m: the longest way from each joint along its links to a capsule's surface."""
    lever_m = np.zeros((3, 3))
    for arm in range(3):
        for j in (2, 1, 0):
            own = body == 3 * arm + j
            reach = (np.linalg.norm(ends_m[own], axis=2) + radius_m[own, None]).max(initial=0.0)
            beyond = 0.0 if j == 2 else np.linalg.norm(T_joint[arm, j + 1, :3, 3]) + lever_m[arm, j + 1]
            lever_m[arm, j] = max(reach, beyond)
    return lever_m
