"""Random frames of random people for training, validation and test: the same seed gives the same frame.

People, clothes and recorded motions of the three splits are disjoint.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Literal

import numpy as np
import numpy.typing as npt

from teleop.body.parts import NO_PART
from teleop.frames import Camera, DepthFrame, kinect_v1, pixels
from teleop.joints import JOINT_INDEX
from teleop.people.body import Body, Bytes, Floats32, skin
from teleop.people.clothes import dress, random_wardrobe
from teleop.people.clutter import add_floor, add_fragment, bite, cut_low
from teleop.people.makehuman import makehuman_body
from teleop.people.mocap import library
from teleop.people.moves import jittered, random_pose
from teleop.people.pose import Pose, pose_rig, yaw
from teleop.people.rig import Floats, arms_in_trunk
from teleop.people.room import random_room
from teleop.people.scene import Figure, shoot, stand
from teleop.people.sensor import SensorModel, sense
from teleop.people.shade import random_light
from teleop.people.shape import random_shape
from teleop.people.view import View, sensor_view, visible_joints

Split = Literal["train", "validation", "test"]
_TRIES: Final = 4
"""Poses drawn at most, to find one whose arms do not run through the trunk."""
PEOPLE: Final = {"train": 1000, "validation": 60, "test": 80}
SEED: Final = {"train": 11, "validation": 22, "test": 33}


@dataclass(frozen=True, slots=True)
class SampleSpec:
    """What to draw: split and image size; with a room round the person (slower) or without; mirrored; with colour.

    any_sensor: tilts up to 16 degrees are as likely as level ones, and noise is that of many sensors.
    """

    split: Split = "train"
    width: int = 640
    height: int = 480
    room: bool = False
    mirrored: bool = False
    color: bool = False
    any_sensor: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class RenderedFrame:
    """One frame with its truth.

    frame: sensor noise applied. part: (H, W) uint8, NO_PART off the person. joints_m: (20, 3) camera axes.
    curl: right and left hand, 0 flat open .. 1 fist. visible: (20,) bool, see ``teleop.people.view.visible_joints``.
    """

    frame: DepthFrame
    part: Bytes
    joints_m: Floats
    visible: npt.NDArray[np.bool_]
    curl: tuple[float, float]


@lru_cache(maxsize=1024)
def person(split: str, number: int) -> Body:
    """Person ``number`` of a split (MakeHuman)."""
    return makehuman_body(random_shape(np.random.default_rng([SEED[split], number])))


def sample_pose(rng: np.random.Generator, split: str) -> Pose:
    """A pose by rule or, where the motion library is there, from a recorded motion of the split."""
    recorded = library(split)
    if recorded is None or rng.uniform() < 0.6:
        return random_pose(rng)
    pose = jittered(recorded.pose(int(rng.integers(len(recorded)))), rng, 0.06)
    if rng.uniform() < 0.4:
        other = random_pose(rng)
        arms = (other.arms[0], pose.arms[1]) if rng.uniform() < 0.5 else (pose.arms[0], other.arms[1])
        return Pose(arms, other.legs, pose.pelvis, pose.chest, pose.head)
    return pose


def random_figure(rng: np.random.Generator, split: str, x_m: float, z_m: float) -> Figure:
    """Somebody of the split, dressed, posed, standing at (x, z) and turned by up to 45 degrees."""
    body = person(split, int(rng.integers(PEOPLE[split])))
    worn = dress(body, random_wardrobe(rng), int(rng.integers(2**31)))
    for _ in range(_TRIES):
        pose = sample_pose(rng, split)
        posed = pose_rig(body.rig, pose)
        if not arms_in_trunk(body.rig, posed):
            break
    turn = yaw(np.radians(rng.uniform(-45, 45) if rng.uniform() < 0.5 else rng.normal(0, 10)))
    return Figure(body, worn, pose, stand(posed, skin(body, posed, worn.vertices_m), x_m, z_m, turn))


def random_view(rng: np.random.Generator, z_m: float, any_tilt: bool) -> View:
    """A sensor 0.6 to 2 m high that looks at somebody z away; any_tilt: every other one just anywhere within 16 deg."""
    height = float(rng.uniform(0.6, 1.4) if rng.uniform() < 0.85 else rng.uniform(1.4, 2.0))
    tilt = float(np.clip(np.arctan((0.95 - height) / z_m) + rng.normal(0, 0.08), -0.27, 0.27))
    if any_tilt and rng.uniform() < 0.4:
        tilt = float(rng.uniform(-0.28, 0.28))
    return sensor_view(height, tilt, float(rng.normal(0, 0.02)))


def random_sensor(rng: np.random.Generator) -> SensorModel:
    """Mostly a Kinect v1, else one with other noise, a shorter base or none (time of flight), finer steps."""
    if rng.uniform() < 0.5:
        return SensorModel()
    return SensorModel(
        lateral_px=float(rng.uniform(0.2, 1.1)),
        axial=float(rng.uniform(0.2, 1.4)),
        base_m=float(rng.choice([0.0, rng.uniform(0.02, 0.08)])),
        grazing_rad=float(rng.uniform(1.2, 1.5)),
        quantised=bool(rng.uniform() < 0.4),
    )


def sample_frame(seed: int, spec: SampleSpec) -> RenderedFrame:
    """A random person in a random pose before a random sensor. Deterministic in seed and spec.

    Raises DataError when the MakeHuman files are missing.
    """
    rng = np.random.default_rng([SEED[spec.split], 7, seed])
    z = float(rng.uniform(1.2, 4.0))
    x = float(rng.uniform(-1, 1)) * min(0.9, 0.33 * z)
    people = [random_figure(rng, spec.split, x, z)]
    view = random_view(rng, z, spec.any_sensor)
    camera = Camera(kinect_v1(spec.width, spec.height), spec.mirrored)
    room = None
    if spec.room:
        room = random_room(rng, np.array([x, 0.0, z]))
        if rng.uniform() < 0.15:
            aside = float(rng.choice([-1.0, 1.0])) * float(rng.uniform(0.8, 1.3))
            people.append(random_figure(rng, spec.split, x + aside, z + float(rng.uniform(-0.2, 1.0))))
    light = random_light(rng) if spec.color else None
    shot = shoot(tuple(people), room, view, camera, light, rng)
    depth, part = shot.depth_m, shot.part
    if not spec.room:
        _cut_out(depth, part, shot.joints_m, camera, view, rng)
    visible = visible_joints(shot.joints_m, depth, part, camera)
    reading = sense(depth, camera, rng, random_sensor(rng) if spec.any_sensor else None)
    seen = np.where(reading.depth_mm > 0, part.ravel()[reading.source], np.uint8(NO_PART))
    arms = people[0].pose.arms
    frame = DepthFrame(0, reading.depth_mm, camera, shot.color_rgb, seed)
    return RenderedFrame(frame, seen, shot.joints_m, visible, (arms[0].curl, arms[1].curl))


def _cut_out(
    depth: Floats32, part: Bytes, joints: Floats, camera: Camera, view: View, rng: np.random.Generator
) -> None:
    """The faults of a segmentation: in some frames bits of the room stay, or bits of the person go."""
    if rng.uniform() < 0.35:
        feet = pixels(joints[[JOINT_INDEX["foot_right"], JOINT_INDEX["foot_left"]]], camera)
        add_floor(depth, part, feet, camera, view.R[:, 1], view.height_m, rng)
    if rng.uniform() < 0.15:
        add_fragment(depth, part, rng)
    for _ in range(int(rng.integers(1, 4)) if rng.uniform() < 0.2 else 0):
        bite(depth, part, rng)
    if rng.uniform() < 0.15:
        low, high = sorted(joints[[JOINT_INDEX["foot_left"], JOINT_INDEX["knee_left"]], 1])
        cut = np.array([0.0, rng.uniform(low, high), joints[JOINT_INDEX["spine"], 2]])
        cut_low(depth, part, max(0, int(pixels(cut, camera)[1])))
