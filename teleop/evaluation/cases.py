"""One rendered frame with its truth, and how it is shot."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from teleop.body.parts import NO_PART
from teleop.frames import Camera, DepthFrame
from teleop.people.body import Body, Bytes, skin
from teleop.people.clothes import Dressed, dress, random_wardrobe
from teleop.people.makehuman import makehuman_body
from teleop.people.pose import Pose, pose_rig
from teleop.people.rig import Floats
from teleop.people.room import Room
from teleop.people.scene import Figure, shoot, stand
from teleop.people.sensor import sense
from teleop.people.shade import Light
from teleop.people.shape import Shape, random_shape
from teleop.people.view import View, visible_joints

PEOPLE_SEED = 7_777
"""Stream of the evaluation's people; training, validation and test of the sampler have their own."""


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A frame and what is true in it.

    joints_m: (20, 3) camera axes; NaN rows where there is no truth. counted: (20,) bool, the joint is seen (rendered)
    or trusted (recorded). part: (H, W) uint8 or None. R_level_camera: (3, 3) true levelling, None where unknown.
    group: what the frame belongs to, such as a subject, a tester or a sequence. level: degrees asked for, NaN if none.
    """

    frame: DepthFrame
    joints_m: Floats
    counted: npt.NDArray[np.bool_]
    part: Bytes | None = None
    R_level_camera: Floats | None = None
    group: int = 0
    level: float = float("nan")


@dataclass(frozen=True, slots=True, eq=False)
class Person:
    """Somebody in their clothes."""

    body: Body
    worn: Dressed


def unseen_person(number: int) -> Person:
    """Person ``number`` of the evaluation, never in any training. Raises DataError without the MakeHuman files."""
    rng = np.random.default_rng([PEOPLE_SEED, number])
    return dressed(random_shape(rng), rng)


def dressed(shape: Shape, rng: np.random.Generator) -> Person:
    """Somebody of this shape in random clothes."""
    body = makehuman_body(shape)
    return Person(body, dress(body, random_wardrobe(rng), int(rng.integers(2**31))))


def placed(person: Person, pose: Pose, x_m: float, z_m: float, turn: Floats) -> Figure:
    """The person in a pose on the floor at (x, z) of the room, turned."""
    posed = pose_rig(person.body.rig, pose)
    return Figure(
        person.body, person.worn, pose, stand(posed, skin(person.body, posed, person.worn.vertices_m), x_m, z_m, turn)
    )


def shot(
    figures: tuple[Figure, ...],
    room: Room | None,
    view: View,
    camera: Camera,
    rng: np.random.Generator,
    light: Light | None = None,
) -> Case:
    """What the sensor reads of the first figure as operator, and what is true."""
    picture = shoot(figures, room, view, camera, light, rng)
    visible = visible_joints(picture.joints_m, picture.depth_m, picture.part, camera)
    reading = sense(picture.depth_m, camera, rng)
    part = np.where(reading.depth_mm > 0, picture.part.ravel()[reading.source], np.uint8(NO_PART)).astype(np.uint8)
    frame = DepthFrame(0, reading.depth_mm, camera, picture.color_rgb)
    return Case(frame, picture.joints_m, visible, part, view.R.T.copy())


def with_dropout(case: Case, share: float, rng: np.random.Generator) -> Case:
    """The same frame with a share of its pixels, single ones, not read."""
    lost = rng.random(case.frame.depth_mm.shape) < share
    depth = np.where(lost, np.uint16(0), case.frame.depth_mm).astype(np.uint16)
    part = None if case.part is None else np.where(lost, np.uint8(NO_PART), case.part).astype(np.uint8)
    return replace(case, frame=replace(case.frame, depth_mm=depth), part=part)
