"""Reads a study's motion back from its MCAP: robot, joint values in time, path and volumes."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from robot_sim.errors import RobotError
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.primitives import Primitive, Rgba, Vec3

TOPICS = ("/robot_description", "/joint_states", "/study/scene", "/tf")


@dataclass(frozen=True, slots=True, eq=False)
class StoredMotion:
    """One motion: times t_s (M,), q (M, n) of the named joints, the tool's path (K, 3) in m, volumes in world axes.

    base_xyz_m, base_rpy_rad: where the robot's base stands. about: the file's words on itself (study, robot).
    """

    urdf: str
    joint_names: tuple[str, ...]
    t_s: FloatArray
    q: FloatArray
    path_m: FloatArray
    path_rgba: Rgba
    volumes: tuple[Primitive, ...]
    base_xyz_m: Vec3
    base_rpy_rad: Vec3
    about: dict[str, str]

    @property
    def duration_s(self) -> float:
        """Time of the last sample."""
        return float(self.t_s[-1])

    def at(self, t_s: float) -> dict[str, float]:
        """Joint values by name at a time, interpolated; the ends hold."""
        values = (np.interp(t_s, self.t_s, self.q[:, i]) for i in range(self.q.shape[1]))
        return {name: float(v) for name, v in zip(self.joint_names, values, strict=True)}


def read_motion(path: Path) -> StoredMotion:
    """Raises RobotError when the file cannot be read, is damaged, or holds no motion of a study."""
    try:
        with path.open("rb") as stream:
            return _assemble(stream)
    except FileNotFoundError:
        raise RobotError(f"no motion at {path}; 'teleop study tomato --quick' makes one") from None
    except OSError as error:
        raise RobotError(f"cannot read {path}: {error.strerror}; give the motion.mcap of a study") from None
    except (McapError, ValueError, KeyError) as error:
        raise RobotError(f"{path} is damaged or no MCAP file ({type(error).__name__}); run the study again") from None
    except _NotAMotion as error:
        raise RobotError(f"{path} has no {error}; give the motion.mcap of 'teleop study'") from None


class _NotAMotion(Exception):
    """Names what a readable file lacks."""


def _assemble(stream: BinaryIO) -> StoredMotion:
    reader = make_reader(stream, decoder_factories=[DecoderFactory()])
    urdf, scene, base = "", None, None
    names: tuple[str, ...] = ()
    times: list[float] = []
    rows: list[list[float]] = []
    for _, channel, message, *decoded in _decoded(reader):
        if channel.topic == "/robot_description":
            urdf = str(json.loads(message.data)["data"])
        elif channel.topic == "/joint_states":
            joints = decoded[0].joints
            names = names or tuple(j.name for j in joints)
            times.append(message.log_time * 1e-9)
            rows.append([float(j.position) for j in joints])
        elif channel.topic == "/study/scene":
            scene = scene or decoded[0]
        elif base is None:
            base = next((t for t in decoded[0].transforms if t.child_frame_id == "base_link"), None)
    if not urdf:
        raise _NotAMotion("robot description")
    if not rows:
        raise _NotAMotion("joint states")
    entities = list(scene.entities) if scene is not None else []
    lines = [line for entity in entities for line in entity.lines]
    path = np.array([[p.x, p.y, p.z] for line in lines for p in line.points], dtype=np.float64).reshape(-1, 3)
    return StoredMotion(
        urdf,
        names,
        np.array(times),
        np.array(rows),
        path,
        _rgba(lines[0].color) if lines else (0.1, 0.6, 1.0, 1.0),
        tuple(p for entity in entities for p in _volumes(entity)),
        (base.translation.x, base.translation.y, base.translation.z) if base else (0.0, 0.0, 0.0),
        _rpy(base.rotation) if base else (0.0, 0.0, 0.0),
        _about(reader),
    )


def _decoded(reader: Any) -> Iterator[tuple[Any, ...]]:
    """Schema, channel, message, decoded message; the description is JSON and is left undecoded."""
    yield from reader.iter_messages(topics=["/robot_description"])
    yield from reader.iter_decoded_messages(topics=[t for t in TOPICS if t != "/robot_description"])


def _about(reader: Any) -> dict[str, str]:
    return {
        key: value
        for record in reader.iter_metadata()
        if record.name == "study"
        for key, value in record.metadata.items()
    }


def _volumes(entity: Any) -> Iterator[Primitive]:
    for cube in entity.cubes:
        yield _primitive("box", (cube.size.x, cube.size.y, cube.size.z), cube)
    for cylinder in entity.cylinders:
        yield _primitive("cylinder", (cylinder.size.x / 2, cylinder.size.z), cylinder)
    for sphere in entity.spheres:
        yield _primitive("sphere", (sphere.size.x / 2,), sphere)


def _primitive(kind: Any, size_m: tuple[float, ...], item: Any) -> Primitive:
    p = item.pose.position
    return Primitive("", kind, size_m, (p.x, p.y, p.z), _rpy(item.pose.orientation), _rgba(item.color))


def _rgba(color: Any) -> Rgba:
    return (color.r, color.g, color.b, color.a)


def _rpy(turn: Any) -> Vec3:
    """Roll, pitch, yaw about fixed axes of a quaternion; looking straight up or down, yaw is taken as zero."""
    x, y, z, w = turn.x, turn.y, turn.z, turn.w
    sine = max(-1.0, min(1.0, 2 * (w * y - z * x)))
    if abs(sine) > 1 - 1e-12:
        return (math.atan2(2 * (w * x - y * z), 1 - 2 * (x * x + z * z)), math.copysign(math.pi / 2, sine), 0.0)
    roll = math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    return (roll, math.asin(sine), math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))
