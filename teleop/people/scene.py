"""One shot of a scene: people in a room before a sensor, to depth, parts and colour."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from teleop.body.parts import NO_PART
from teleop.frames import Camera, ColorImage
from teleop.joints import N_JOINTS
from teleop.people.body import Body, Bytes, Floats32, Ints32, skin, vertex_normals
from teleop.people.clothes import Dressed
from teleop.people.pose import Pose
from teleop.people.render import Raster, draw, empty_raster
from teleop.people.rig import Floats, Posed, joints_m
from teleop.people.room import Room, draw_planes
from teleop.people.shade import Light, shade
from teleop.people.view import View


@dataclass(frozen=True, slots=True, eq=False)
class Figure:
    """A dressed person in a pose, placed in the room (posed: in room axes)."""

    body: Body
    worn: Dressed
    pose: Pose
    posed: Posed


@dataclass(frozen=True, slots=True, eq=False)
class Shot:
    """True depth (H, W) float32 metres, inf where nothing is; parts of the first person (H, W) uint8; the others'
    pixels (H, W) bool; colour or None; joints (20, 3) of the
    first person in camera axes; NaN without one."""

    depth_m: Floats32
    part: Bytes
    others: npt.NDArray[np.bool_]
    color_rgb: ColorImage | None
    joints_m: Floats


def stand(posed: Posed, vertices_m: Floats32, x_m: float, z_m: float, turn: Floats) -> Posed:
    """Put a posed person into the room: pelvis over (x, z), turned, lowest point on the floor."""
    low = np.array([posed.p_m[0, 0], float(vertices_m[:, 1].min()), posed.p_m[0, 2]])
    return posed.moved(turn, np.array([x_m, 0.0, z_m]) - turn @ low)


def shoot(
    people: tuple[Figure, ...],
    room: Room | None,
    view: View,
    camera: Camera,
    light: Light | None = None,
    rng: np.random.Generator | None = None,
) -> Shot:
    """Draw people, furniture, floor and walls; colour only when a light and its random generator are given."""
    raster = empty_raster(camera)
    meshes, first = [], 0
    for figure in people:
        placed = figure.posed.moved(view.R, view.t_m)
        points = skin(figure.body, placed, figure.worn.vertices_m)
        draw(raster, camera, points, figure.body.faces, first)
        meshes.append((points, figure.body.faces, figure.worn.color_rgb.astype(np.float32)))
        first += len(figure.body.faces)
    people_faces = first
    if room is not None:
        if len(room.faces):
            corners = room.vertices_m[room.faces].reshape(-1, 3)
            points = (corners @ view.R.T + view.t_m).astype(np.float32)
            faces = np.arange(len(points), dtype=np.int32).reshape(-1, 3)
            draw(raster, camera, points, faces, first)
            meshes.append((points, faces, np.repeat(room.face_rgb, 3, axis=0).astype(np.float32)))
        draw_planes(raster, camera, room, view)
    if people:
        operator = people[0].body
        mine = (raster.face >= 0) & (raster.face < len(operator.faces))
        part = np.where(mine, operator.face_part[np.where(mine, raster.face, 0)], np.uint8(NO_PART))
        others = (raster.face >= len(operator.faces)) & (raster.face < people_faces)
        joints = joints_m(operator.rig, people[0].posed.moved(view.R, view.t_m))
    else:
        part = np.full(raster.face.shape, NO_PART, np.uint8)
        others = np.zeros(raster.face.shape, np.bool_)
        joints = np.full((N_JOINTS, 3), np.nan)
    color = None
    if light is not None and rng is not None:
        color = _color(raster, camera, view, room, meshes, light, rng)
    return Shot(raster.depth_m, part, others, color, joints)


def _color(
    raster: Raster,
    camera: Camera,
    view: View,
    room: Room | None,
    meshes: list[tuple[Floats32, Ints32, Floats32]],
    light: Light,
    rng: np.random.Generator,
) -> ColorImage:
    starts = np.cumsum([0] + [len(points) for points, _, _ in meshes])
    points = np.concatenate([m[0] for m in meshes])
    faces = np.concatenate([m[1] + start for m, start in zip(meshes, starts[:-1], strict=True)]).astype(np.int32)
    normals = np.concatenate([vertex_normals(m[0], m[1]) for m in meshes])
    # Leaves and boxes are lit from both sides: turn every normal towards the sensor.
    away = np.einsum("ij,ij->i", normals, points) > 0
    normals[away] *= -1
    rgb = np.concatenate([m[2] for m in meshes])
    return shade(raster, camera, view, room, points, normals, faces, rgb, light, rng)
