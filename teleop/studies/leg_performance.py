"""Rendered people who pick and spray for five minutes on legs that move as recorded people's do."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.data import data_folder
from teleop.frames import Camera, DepthFrame, kinect_v1
from teleop.people.body import skin
from teleop.people.clothes import dress, random_wardrobe
from teleop.people.makehuman import makehuman_body
from teleop.people.mocap import PoseLibrary, standing_clips
from teleop.people.moves import hanging_arm, plane_arm, reaching_arm
from teleop.people.pose import LegPose, Pose, pose_rig, rotation, unit
from teleop.people.room import greenhouse_room
from teleop.people.scene import Figure, shoot, stand
from teleop.people.sensor import sense
from teleop.people.shape import Shape
from teleop.people.view import sensor_view
from teleop.sources.virtual_options import SENSOR_HEIGHT_M, SENSOR_TILT_RAD

F64 = npt.NDArray[np.float64]
PEOPLE: Final = tuple(
    zip(
        (1.65, 1.67, 1.70, 1.72, 1.74, 1.77, 1.80, 1.83, 1.86, 1.90),
        (45.0, 56.0, 52.0, 68.0, 61.0, 75.0, 66.0, 84.0, 78.0, 90.0),
        strict=True,
    )
)
"""Height [m] and mass [kg]; the source's ten people were 165-190 cm and 45-90 kg."""
PICKING_APART_RAD: Final = np.radians(20.0)
STAND_Z_M: Final = 3.1
"""The feet must be in the image, and here a level sensor at 1.2 m sees the floor."""


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """One second of somebody. frames: the last few of it, at 30 Hz; joints_m (20, 3): true at the last, camera axes."""

    frames: tuple[DepthFrame, ...]
    joints_m: F64
    picking: bool


def legs_of(clips: PoseLibrary, i: int, base: F64, apart_rad: float) -> tuple[LegPose, LegPose]:
    """The recorded movement of the legs about their own mean, laid over a stance.

    base (2, 2, 3): mean thigh and shin of the clip, right then left. The movement, not the dancer's stance, is
    taken: everybody stands as the task wants, and sways, steps and shifts weight as the recorded person does.
    """
    legs = []
    for k, sign in ((0, 1.0), (1, -1.0)):
        stance = rotation(np.array([0.0, 0.0, 1.0]), sign * 0.5 * apart_rad) @ np.array([0.0, -1.0, 0.0])
        thigh = unit(stance + clips.limbs[i, k, 2] - base[k, 0])
        shin = unit(stance + clips.limbs[i, k, 3] - base[k, 1])
        legs.append(LegPose(thigh, shin, clips.limbs[i, k, 4]))
    return legs[0], legs[1]


def perform(
    number: int, seconds: int, seed: int, size: tuple[int, int] = (320, 240), burst: int = 1
) -> Iterator[Sample]:
    """Person ``number`` of PEOPLE, once a second: picking in the first half, spraying in the second.

    size: of the images; the default is the tracker's own working resolution. burst: frames of each second.

    Raises DataError without the motion capture or the MakeHuman files.
    """
    data_folder("cmu_mocap")
    clips = standing_clips()
    rng = np.random.default_rng([seed, number])
    height_m, mass_kg = PEOPLE[number]
    body = makehuman_body(Shape(height_m, mass_kg, female=float(number % 2), age=0.1 + 0.05 * number))
    worn = dress(body, random_wardrobe(rng), int(rng.integers(2**31)))
    room, view, camera = (
        greenhouse_room(number),
        sensor_view(SENSOR_HEIGHT_M, SENSOR_TILT_RAD),
        Camera(kinect_v1(*size)),
    )
    start = int(rng.integers(10_000))
    for second in range(seconds):
        picking = second < seconds // 2
        # 60 Hz; after a whole round the samples fall between the earlier ones
        at = (start + 60 * second + 17 * (60 * second // sum(map(len, clips)))) % sum(map(len, clips))
        recorded, at = _clip_at(clips, at)
        base = np.array([[unit(recorded.limbs[:, k, j].mean(axis=0)) for j in (2, 3)] for k in range(2)])
        arms = [plane_arm(rng, 1.0) if rng.uniform() < 0.7 else reaching_arm(rng, 1.0)]
        arms.append(plane_arm(rng, -1.0) if picking else hanging_arm(rng, -1.0))
        frames, joints = [], np.empty(0)
        for k in range(burst):
            moment = max(0, at - 2 * (burst - 1 - k))  # every second of 60 Hz
            legs = legs_of(recorded, moment, base, PICKING_APART_RAD if picking else 0.0)
            pelvis, chest, head = recorded.trunk[moment]
            pose = Pose((arms[0], arms[1]), legs, pelvis, chest, head)
            posed = pose_rig(body.rig, pose)
            placed = stand(posed, skin(body, posed, worn.vertices_m), 0.0, STAND_Z_M, np.eye(3))
            shot = shoot((Figure(body, worn, pose, placed),), room, view, camera)
            depth, joints = sense(shot.depth_m, camera, rng).depth_mm, shot.joints_m
            t_ns = second * 1_000_000_000 - (burst - 1 - k) * 33_333_333
            frames.append(DepthFrame(t_ns, depth, camera, None, second))
        yield Sample(tuple(frames), joints, picking)


def _clip_at(clips: tuple[PoseLibrary, ...], at: int) -> tuple[PoseLibrary, int]:
    """The clip and the frame in it, of a frame number over all clips."""
    clip = 0
    while at >= len(clips[clip]):
        at, clip = at - len(clips[clip]), clip + 1
    return clips[clip], at
