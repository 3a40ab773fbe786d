"""A study's motion as an MCAP recording: robot description, joint states, transforms, path and volumes.

Topics and encodings are those of the product's recordings, so that the console and Foxglove play it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from foxglove import Channel, Context, Schema, open_mcap
from foxglove import messages as msg
from foxglove.channels import FrameTransformsChannel, JointStatesChannel, SceneUpdateChannel

from robot_sim.errors import RobotError
from robot_sim.kinematics.chain import Chain
from robot_sim.kinematics.transforms import FloatArray, to_quaternion, translation
from robot_sim.planner.shapes import Box, Cylinder, Solid, Sphere

Rgba = tuple[float, float, float, float]
_STRING_SCHEMA = {"type": "object", "properties": {"data": {"type": "string"}}}


def _position_turn(T: FloatArray) -> tuple[msg.Vector3, msg.Quaternion]:
    x, y, z, w = to_quaternion(T)
    px, py, pz = (float(v) for v in T[:3, 3])
    return msg.Vector3(x=px, y=py, z=pz), msg.Quaternion(x=x, y=y, z=z, w=w)


def _pose(T: FloatArray) -> msg.Pose:
    position, turn = _position_turn(T)
    return msg.Pose(position=position, orientation=turn)


def _primitives(solids: Sequence[tuple[Solid, Rgba]]) -> msg.SceneEntity:
    cubes, cylinders, spheres = [], [], []
    for solid, rgba in solids:
        color = msg.Color(r=rgba[0], g=rgba[1], b=rgba[2], a=rgba[3])
        pose = _pose(solid.T)
        if isinstance(solid, Box):
            a, b, c = (2 * h for h in solid.half_m)
            cubes.append(msg.CubePrimitive(pose=pose, size=msg.Vector3(x=a, y=b, z=c), color=color))
        elif isinstance(solid, Cylinder):
            d = 2 * solid.radius_m
            size = msg.Vector3(x=d, y=d, z=solid.height_m)
            cylinders.append(msg.CylinderPrimitive(pose=pose, size=size, bottom_scale=1.0, top_scale=1.0, color=color))
        elif isinstance(solid, Sphere):
            d = 2 * solid.radius_m
            spheres.append(msg.SpherePrimitive(pose=pose, size=msg.Vector3(x=d, y=d, z=d), color=color))
        else:
            raise RobotError(f"no scene primitive for {type(solid).__name__}")
    return msg.SceneEntity(frame_id="world", id="volumes", cubes=cubes, cylinders=cylinders, spheres=spheres)


def _path(points_m: FloatArray, rgba: Rgba) -> msg.SceneEntity:
    line = msg.LinePrimitive(
        type=msg.LinePrimitiveLineType.LineStrip,
        thickness=0.004,
        points=[msg.Point3(x=float(x), y=float(y), z=float(z)) for x, y, z in points_m],
        color=msg.Color(r=rgba[0], g=rgba[1], b=rgba[2], a=rgba[3]),
    )
    return msg.SceneEntity(frame_id="world", id="path", lines=[line])


def _transforms(t: msg.Timestamp, chain: Chain, T_world_base: FloatArray, q: FloatArray) -> msg.FrameTransforms:
    """World to base_link, then link by link; frame names are the URDF's."""

    def one(parent: str, child: str, T: FloatArray) -> msg.FrameTransform:
        position, turn = _position_turn(T)
        return msg.FrameTransform(
            timestamp=t,
            parent_frame_id=parent,
            child_frame_id=child,
            translation=position,
            rotation=turn,
        )

    out = [one("world", "base_link", T_world_base)]
    parent = "base_link"
    for i, (j, value) in enumerate(zip(chain.joints, q, strict=True)):
        T = chain.fixed[i].copy()
        if j.kind == "prismatic":
            T = T @ translation(0, 0, float(value))
        else:
            c, s = np.cos(value), np.sin(value)
            T = T @ np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
        out.append(one(parent, f"link{i + 1}", T))
        parent = f"link{i + 1}"
    out.append(one(parent, "tool0", chain.fixed[-1]))
    return msg.FrameTransforms(transforms=out)


def write_motion(
    path: Path,
    urdf: str,
    chain: Chain,
    t_s: FloatArray,
    q: FloatArray,
    *,
    tool_joints: Mapping[str, FloatArray] | None = None,
    T_world_base: FloatArray | None = None,
    solids: Sequence[tuple[Solid, Rgba]] = (),
    path_color: Rgba = (0.1, 0.6, 1.0, 1.0),
    about: Mapping[str, str] | None = None,
) -> Path:
    """Write one motion: times (M,) in s, arm joints q (M, n), tool joints by name (M,) each.

    solids are drawn in world axes, the tool's path as a line. An existing file is replaced. Raises RobotError when
    the file cannot be written.
    """
    base = np.eye(4) if T_world_base is None else T_world_base
    tools = dict(tool_joints or {})
    names = [j.name for j in chain.joints] + list(tools)
    values = np.column_stack([q, *tools.values()]) if tools else q
    context = Context()
    try:
        writer = open_mcap(path, allow_overwrite=True, context=context)
    except (OSError, RuntimeError) as error:
        raise RobotError(f"cannot write {path}: {error}; choose another --output") from None
    schema = Schema(name="std_msgs/String", encoding="jsonschema", data=json.dumps(_STRING_SCHEMA).encode())
    with writer:
        writer.write_metadata("study", {"robot": chain.name} | dict(about or {}))
        description = Channel("/robot_description", schema=schema, message_encoding="json", context=context)
        states = JointStatesChannel("/joint_states", context=context)
        tf = FrameTransformsChannel("/tf", context=context)
        scene = SceneUpdateChannel("/study/scene", context=context)
        description.log(json.dumps({"data": urdf}).encode(), log_time=0)
        tool_path = (base @ chain.forward(q))[:, :3, 3]
        scene.log(msg.SceneUpdate(entities=[_primitives(solids), _path(tool_path, path_color)]), log_time=0)
        for k, t in enumerate(t_s):
            t_ns = round(float(t) * 1e9)
            stamp = msg.Timestamp(sec=t_ns // 10**9, nsec=t_ns % 10**9)
            joints = [msg.JointState(name=n, position=float(v)) for n, v in zip(names, values[k], strict=True)]
            states.log(msg.JointStates(timestamp=stamp, joints=joints), log_time=t_ns)
            tf.log(_transforms(stamp, chain, base, q[k]), log_time=t_ns)
    return path
