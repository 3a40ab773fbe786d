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
from teleop.people.body import Body, Bytes, Floats32, skin
from teleop.people.clothes import dress, random_wardrobe
from teleop.people.makehuman import makehuman_body
from teleop.people.mocap import library
from teleop.people.moves import jittered, random_pose
from teleop.people.pose import Pose, pose_rig, rotation, yaw
from teleop.people.render import draw, empty_raster
from teleop.people.rig import Floats, Posed, joints_m
from teleop.people.sensor import sense
from teleop.people.shape import random_shape

Split = Literal["train", "validation", "test"]
_PEOPLE: Final = {"train": 400, "validation": 60, "test": 80}
_SEED: Final = {"train": 11, "validation": 22, "test": 33}
SEEN_RADIUS_M: Final = 0.08
SEEN_BEHIND_M: Final = 0.25


@dataclass(frozen=True, slots=True)
class SampleSpec:
    """What to draw: the split, the image, whether a room stands round the person (slower), and whether it is mirrored."""

    split: Split = "train"
    width: int = 640
    height: int = 480
    room: bool = False
    mirrored: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class RenderedFrame:
    """One frame with its truth.

    frame: sensor noise applied. part: (H, W) uint8, NO_PART off the person. joints_m: (20, 3) camera axes.
    visible: (20,) bool: some pixel of the joint's part lies within 8 cm of it across the line of sight and at most
    25 cm in front of it, so the joint's neighbourhood is in the image and not hidden.
    """

    frame: DepthFrame
    part: Bytes
    joints_m: Floats
    visible: npt.NDArray[np.bool_]


@lru_cache(maxsize=512)
def person(split: str, number: int) -> Body:
    """Person ``number`` of a split (MakeHuman)."""
    return makehuman_body(random_shape(np.random.default_rng([_SEED[split], number])))


def camera_view(height_m: float, tilt_rad: float, roll_rad: float = 0.0) -> tuple[Floats, Floats]:
    """Rotation and translation from the levelled room (floor y = 0 under the camera) to camera axes; tilt > 0 looks up."""
    R = rotation(np.array([0.0, 0.0, 1.0]), roll_rad) @ rotation(np.array([1.0, 0.0, 0.0]), tilt_rad)
    return R, R @ np.array([0.0, -height_m, 0.0])


def visible_joints(joints: Floats, depth_m: Floats32, part: Bytes, camera: Camera) -> npt.NDArray[np.bool_]:
    """Which joints' neighbourhoods are seen, (20,) bool; see RenderedFrame.visible."""
    out = np.zeros(len(joints), np.bool_)
    uv = pixels(joints, camera)
    h, w = part.shape
    for j, (u, v) in enumerate(uv):
        z = joints[j, 2]
        if z < 0.3:
            continue
        r = SEEN_RADIUS_M * camera.depth.fx / z
        u0, u1, v0, v1 = int(max(0, u - r)), int(min(w, u + r + 1)), int(max(0, v - r)), int(min(h, v + r + 1))
        if u0 >= u1 or v0 >= v1:
            continue
        seen = depth_m[v0:v1, u0:u1]
        out[j] = bool(((part[v0:v1, u0:u1] == j) & (seen > z - SEEN_BEHIND_M) & (seen < z + SEEN_RADIUS_M)).any())
    return out


def _sample_pose(rng: np.random.Generator, split: str) -> Pose:
    recorded = library(split)
    if recorded is None or rng.uniform() < 0.6:
        return random_pose(rng)
    pose = jittered(recorded.pose(int(rng.integers(len(recorded)))), rng, 0.06)
    if rng.uniform() < 0.4:
        other = random_pose(rng)
        arms = (other.arms[0], pose.arms[1]) if rng.uniform() < 0.5 else (pose.arms[0], other.arms[1])
        return Pose(arms, other.legs, pose.pelvis, pose.chest, pose.head)
    return pose


def _place(posed: Posed, vertices: Floats32, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Where the person stands in the room: turn (3, 3) and shift (3,); feet on the floor."""
    z = rng.uniform(1.2, 4.0)
    x = rng.uniform(-1, 1) * min(0.9, 0.38 * z)
    turn = yaw(np.radians(rng.uniform(-45, 45) if rng.uniform() < 0.5 else rng.normal(0, 10)))
    shift = np.array([x, 0.0, z]) - turn @ np.array([posed.p_m[0, 0], vertices[:, 1].min(), posed.p_m[0, 2]])
    return turn, shift


def sample_frame(seed: int, spec: SampleSpec) -> RenderedFrame:
    """A random person in a random pose before a random sensor. Deterministic in seed and spec.

    Raises DataError when the MakeHuman files are missing.
    """
    rng = np.random.default_rng([_SEED[spec.split], 7, seed])
    body = person(spec.split, int(rng.integers(_PEOPLE[spec.split])))
    worn = dress(body, random_wardrobe(rng), int(rng.integers(2**31)))
    posed = pose_rig(body.rig, _sample_pose(rng, spec.split))
    local = skin(body, posed, worn.vertices_m)
    turn, shift = _place(posed, local, rng)
    height = rng.uniform(0.6, 1.4) if rng.uniform() < 0.85 else rng.uniform(1.4, 2.0)
    tilt = float(np.clip(np.arctan((0.95 - height) / shift[2]) + rng.normal(0, 0.08), -0.27, 0.27))
    R, t = camera_view(height, tilt, float(rng.normal(0, 0.02)))
    R, t = R @ turn, R @ shift + t
    camera = Camera(kinect_v1(spec.width, spec.height), spec.mirrored)
    raster = empty_raster(camera)
    draw(raster, camera, (local @ R.T + t).astype(np.float32), body.faces)
    depth = raster.depth_m
    part = np.where(raster.face >= 0, body.face_part[np.maximum(raster.face, 0)], np.uint8(NO_PART))
    joints = joints_m(body.rig, posed.moved(R, t))
    visible = visible_joints(joints, depth, part, camera)
    depth_mm = sense(depth, camera, rng)
    part[depth_mm == 0] = NO_PART
    return RenderedFrame(DepthFrame(0, depth_mm, camera), part, joints, visible)
