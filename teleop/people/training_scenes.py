"""Whole scenes for training: an operator among things and other people, or a room where nobody is.

Unlike ``sampling.sample_frame`` nothing is cut out: telling the operator from the rest is what is to be learned.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from teleop.body.parts import NO_PART
from teleop.frames import Camera, DepthFrame, kinect_v1
from teleop.joints import N_JOINTS
from teleop.people.body import Bytes
from teleop.people.rig import Floats
from teleop.people.room import Room, furnished, random_room
from teleop.people.sampling import SEED, Split, random_figure, random_sensor, random_view
from teleop.people.scene import Figure, shoot
from teleop.people.sensor import sense
from teleop.people.things import low_thing, random_thing
from teleop.people.view import visible_joints


@dataclass(frozen=True, slots=True, eq=False)
class SceneFrame:
    """One frame of a scene. part: (H, W) uint8 of the operator, NO_PART elsewhere. others: (H, W) bool, other people.

    joints_m: (20, 3) camera axes, NaN where nobody is. visible: (20,) bool.
    """

    frame: DepthFrame
    part: Bytes
    others: npt.NDArray[np.bool_]
    joints_m: Floats
    visible: npt.NDArray[np.bool_]


def sample_scene(seed: int, split: Split, width: int, height: int, *, mirrored: bool, nobody: bool) -> SceneFrame:
    """A random scene; things stand within arm's reach of the operator, before the legs, or where an operator would.

    Deterministic in its arguments. Raises DataError when the MakeHuman files are missing.
    """
    rng = np.random.default_rng([SEED[split], 8, seed, int(nobody)])
    z = float(rng.uniform(1.2, 4.0))
    x = float(rng.uniform(-1, 1)) * min(0.9, 0.33 * z)
    view = random_view(rng, z, True)
    camera = Camera(kinect_v1(width, height), mirrored)
    room = random_room(rng, np.array([x, 0.0, z]))
    if nobody:
        for _ in range(int(rng.integers(0, 4))):
            at = x + float(rng.normal(0, 0.7)), max(1.0, z + float(rng.normal(0, 0.5)))
            room = furnished(room, random_thing(rng), *at, float(rng.uniform(0, 2 * np.pi)))
        people: tuple[Figure, ...] = ()
    else:
        room = _clutter(rng, room, x, z)
        people = (random_figure(rng, split, x, z), *_others(rng, split, x, z))
    shot = shoot(people, room, view, camera)
    reading = sense(shot.depth_m, camera, rng, random_sensor(rng))
    read = reading.depth_mm > 0
    part = np.where(read, shot.part.ravel()[reading.source], np.uint8(NO_PART)).astype(np.uint8)
    others = read & shot.others.ravel()[reading.source]
    frame = DepthFrame(0, reading.depth_mm, camera, seq=seed)
    if nobody:
        return SceneFrame(frame, part, others, np.full((N_JOINTS, 3), np.nan), np.zeros(N_JOINTS, np.bool_))
    visible = visible_joints(shot.joints_m, shot.depth_m, shot.part, camera)
    return SceneFrame(frame, part, others, shot.joints_m, visible)


def _clutter(rng: np.random.Generator, room: Room, x_m: float, z_m: float) -> Room:
    """Things beside, behind and before somebody at (x, z)."""
    for _ in range(int(rng.choice([0, 1, 2, 3], p=[0.2, 0.4, 0.3, 0.1]))):
        aside = float(rng.choice([-1.0, 1.0])) * float(rng.uniform(0.25, 1.1))
        behind = float(rng.uniform(-0.25, 0.6))
        room = furnished(room, random_thing(rng), x_m + aside, z_m + behind, float(rng.uniform(0, 2 * np.pi)))
    if rng.uniform() < 0.25 and z_m > 1.7:
        before = float(rng.uniform(0.25, 0.9))
        aside = float(rng.normal(0, 0.25))
        room = furnished(
            room, low_thing(rng, float(rng.uniform(0.4, 0.95))), x_m + aside, z_m - before, float(rng.normal(0, 0.3))
        )
    if rng.uniform() < 0.15:
        room = furnished(
            room, random_thing(rng), x_m + float(rng.normal(0, 0.2)), z_m + float(rng.uniform(0.3, 0.8)), 0.0
        )
    return room


def _others(rng: np.random.Generator, split: Split, x_m: float, z_m: float) -> list[Figure]:
    """One more person in three of ten scenes, rarely two: behind, or beside and not nearer than the operator."""
    out = []
    for _ in range(int(rng.choice([0, 1, 2], p=[0.7, 0.26, 0.04]))):
        aside = float(rng.choice([-1.0, 1.0])) * float(rng.uniform(0.1, 1.3))
        behind = float(rng.uniform(0.4, 1.5)) if abs(aside) < 0.6 else float(rng.uniform(-0.1, 1.2))
        figure = random_figure(rng, split, x_m + aside, z_m + behind)
        out.append(figure)
    return out
