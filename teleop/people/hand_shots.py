"""Single hands of random people, rendered as small windows of the sensor's image: many and cheap, for training.

People, poses, sensors and lights are drawn as in ``teleop.people.sampling``, whose splits are kept; beside that, walls
and shirts are often skin-coloured, which is what colour rules fail on.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from teleop.frames import Camera, DepthFrame, Intrinsics, kinect_v1, pixels
from teleop.intent_types import SIDES, Side
from teleop.joints import JOINT_INDEX
from teleop.people.body import skin
from teleop.people.clothes import Wardrobe, cloth_rgb, dress, random_wardrobe, skin_tone
from teleop.people.pose import Pose, pose_rig, yaw
from teleop.people.rig import BONE, Floats, arms_in_trunk, joints_m
from teleop.people.room import Room, random_room
from teleop.people.sampling import PEOPLE, SEED, Split, person, sample_pose
from teleop.people.scene import Figure, Shot, shoot, stand
from teleop.people.sensor import sense
from teleop.people.shade import random_light
from teleop.people.view import sensor_view, visible_joints

WINDOW_M: Final = 0.56
"""Side of the window, at the hand."""
BETWEEN: Final = (0.14, 0.86)
"""Curl of hands that are neither open nor a fist."""
_TRIES: Final = 4


@dataclass(frozen=True, slots=True, eq=False)
class HandShot:
    """One hand. frame: the sensor's image, or a window of it with a camera to match. joints_m: (20, 3), camera axes.

    curl: 0 flat open .. 1 fist. skin_rgb: the operator's skin as the light shows it, (3,). tone: mean of the unlit
    skin's R, G, B, 0..255. light: exposure, 1 normal. skin_wall: walls painted in skin colours. palm_cos: between the
    palm's normal and the ray, 1 palm to the sensor, 0 edge-on, -1 back of the hand to the sensor. gloved: so it is.
    """

    frame: DepthFrame
    joints_m: Floats
    side: Side
    curl: float
    skin_rgb: Floats
    tone: float
    light: float
    skin_wall: bool
    palm_cos: float
    gloved: bool = False


def skin_walls(room: Room, rng: np.random.Generator) -> Room:
    """The same room with walls painted in skin colours; the floor stays."""
    rgb = room.plane_rgb.copy()
    rgb[1:] = [np.clip(np.array(skin_tone(rng)) * rng.uniform(0.85, 1.15), 0, 250) for _ in rgb[1:]]
    return replace(room, plane_rgb=rgb)


def _set_curl(pose: Pose, curls: tuple[float, float]) -> Pose:
    right, left = (replace(arm, curl=curl) for arm, curl in zip(pose.arms, curls, strict=True))
    return replace(pose, arms=(right, left))


def _curl(rng: np.random.Generator, own: np.random.Generator, between: float) -> float:
    curl = rng.uniform(0.0, BETWEEN[0]) if rng.uniform() < 0.5 else rng.uniform(BETWEEN[1], 1.0)
    return float(own.uniform(*BETWEEN) if own.uniform() < between else curl)


def _gloved(wear: Wardrobe, rng: np.random.Generator) -> Wardrobe:
    """The same clothes with gloves, from thin nitrile to padded leather."""
    return replace(wear, gloves_rgb=cloth_rgb(rng), gloves_m=float(rng.uniform(0.0005, 0.004)))


def window(camera: Camera, point_m: Floats) -> Camera | None:
    """The part of a camera's image round a point (3,), as a camera; None when the point is off the image."""
    k = camera.depth
    u, v = pixels(point_m, camera)
    if not (0 <= u < k.width and 0 <= v < k.height):
        return None
    half = 0.5 * WINDOW_M * k.fx / float(point_m[2])
    u0, v0 = max(0, round(u - half)), max(0, round(v - half))
    u1, v1 = min(k.width, round(u + half)), min(k.height, round(v + half))
    return replace(camera, depth=Intrinsics(k.fx, k.fy, k.cx - u0, k.cy - v0, u1 - u0, v1 - v0))


def _palm_cos(figure: Figure, R: Floats, joints: Floats, i: int) -> float:
    """Cosine between the palm's normal and the direction from the hand to the sensor."""
    side = SIDES[i]
    normal = R @ figure.posed.R[BONE[f"hand_{side}"]] @ figure.body.rig.palm[i]
    hand = joints[JOINT_INDEX[f"hand_{side}"]]
    return float(-normal @ hand / np.linalg.norm(hand))


def hand_shots(
    seed: int, split: Split, whole: bool = False, gloves: float = 0.0, between: float = 0.0
) -> Iterator[HandShot]:
    """Both hands of one random person, those that are in the image and not hidden. Deterministic.

    whole: give the whole image with each hand instead of a window of it, drawn once. gloves: chance that the person
    wears some. between: chance that a hand is neither flat open nor a fist; all else of the person stays the same.

    Raises DataError when the MakeHuman files are missing.
    """
    rng, own = np.random.default_rng([SEED[split], 13, seed]), np.random.default_rng([SEED[split], 14, seed])
    z = float(rng.uniform(1.5, 3.6))
    x = float(rng.uniform(-1, 1)) * min(0.9, 0.33 * z)
    body = person(split, int(rng.integers(PEOPLE[split])))
    wear = random_wardrobe(rng)
    if rng.uniform() < 0.12:
        wear = replace(wear, top_rgb=skin_tone(rng))
    gloved = bool(own.uniform() < gloves)
    worn = dress(body, _gloved(wear, own) if gloved else wear, int(rng.integers(2**31)))
    curls = (_curl(rng, own, between), _curl(rng, own, between))
    for _ in range(_TRIES):
        pose = _set_curl(sample_pose(rng, split), curls)
        posed = pose_rig(body.rig, pose)
        if not arms_in_trunk(body.rig, posed):
            break
    turn = yaw(np.radians(rng.uniform(-45, 45) if rng.uniform() < 0.5 else rng.normal(0, 10)))
    figure = Figure(body, worn, pose, stand(posed, skin(body, posed, worn.vertices_m), x, z, turn))
    height = float(rng.uniform(0.6, 1.4) if rng.uniform() < 0.85 else rng.uniform(1.4, 2.0))
    tilt = float(np.clip(np.arctan((0.95 - height) / z) + rng.normal(0, 0.08), -0.27, 0.27))
    view = sensor_view(height, tilt, float(rng.normal(0, 0.02)))
    full = Camera(kinect_v1(*((640, 480) if rng.uniform() < 0.67 else (320, 240))), bool(rng.uniform() < 0.2))
    room = random_room(rng, np.array([x, 0.0, z])) if rng.uniform() < 0.8 else None
    skin_wall = room is not None and bool(rng.uniform() < 0.4)
    if room is not None and skin_wall:
        room = skin_walls(room, rng)
    light = random_light(rng)
    lit_rgb = np.array(wear.skin_rgb) * np.array(light.rgb) * light.level
    joints = joints_m(body.rig, figure.posed.moved(view.R, view.t_m))
    drawn: tuple[Shot, DepthFrame] | None = None
    for i, side in enumerate(SIDES):
        hand = JOINT_INDEX[f"hand_{side}"]
        camera = window(full, joints[hand]) if joints[hand, 2] > 1.2 else None
        if camera is None:
            continue
        camera = full if whole else camera
        if drawn is None or not whole:
            shot = shoot((figure,), room, view, camera, light, rng)
            # the sensor's noise depends on the full image's resolution, not on the window's
            depth_mm = sense(shot.depth_m, full, rng).depth_mm
            drawn = shot, DepthFrame(0, depth_mm, camera, shot.color_rgb, seed)
        shot, frame = drawn
        if visible_joints(joints, shot.depth_m, shot.part, camera)[hand]:
            palm_cos = _palm_cos(figure, view.R, joints, i)
            tone = float(np.mean(wear.skin_rgb))
            yield HandShot(frame, joints, side, curls[i], lit_rgb, tone, light.level, skin_wall, palm_cos, gloved)
