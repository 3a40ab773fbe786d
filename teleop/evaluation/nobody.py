"""Rooms without a person: a tracker must find nobody there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from teleop.evaluation.cases import Case
from teleop.evaluation.objects import KINDS
from teleop.frames import Camera, DepthFrame, kinect_v1
from teleop.joints import N_JOINTS
from teleop.people.render import draw, empty_raster
from teleop.people.room import Room, draw_planes, furnished, random_room
from teleop.people.sensor import sense
from teleop.people.view import View, sensor_view

PER_BATCH = 10
ALONE = "empty room"
KIND_NAMES = (ALONE, *sorted(KINDS))


@dataclass(frozen=True, slots=True)
class Nobody:
    """Each batch: frames of rooms with one kind of thing in the working area; ``group`` is the index in KIND_NAMES."""

    width: int = 640
    height: int = 480
    mirrored: bool = False
    seed: int = 59

    def batch(self, index: int) -> list[Case]:
        """PER_BATCH frames, kinds in turn from batch to batch."""
        kind = index % len(KIND_NAMES)
        return [self._case(kind, PER_BATCH * index + n) for n in range(PER_BATCH)]

    def _case(self, kind: int, number: int) -> Case:
        rng = np.random.default_rng([self.seed, number])
        x, z = float(rng.uniform(-0.6, 0.6)), float(rng.uniform(1.5, 3.4))
        room = random_room(rng, np.array([x, 0.0, z]))
        if kind:
            mesh = KINDS[KIND_NAMES[kind]](rng)
            room = furnished(room, mesh, x, z, float(rng.uniform(0, 2 * np.pi)))
        view = sensor_view(float(rng.uniform(0.6, 1.4)), np.radians(rng.uniform(-12, 8)), float(rng.normal(0, 0.02)))
        camera = Camera(kinect_v1(self.width, self.height), self.mirrored)
        depth = sense(_room_depth(room, view, camera), camera, rng).depth_mm
        frame = DepthFrame(0, depth, camera, seq=number)
        return Case(frame, np.full((N_JOINTS, 3), np.nan), np.zeros(N_JOINTS, np.bool_), group=kind)


def _room_depth(room: Room, view: View, camera: Camera) -> np.ndarray:
    raster = empty_raster(camera)
    if len(room.faces):
        corners = room.vertices_m[room.faces].reshape(-1, 3)
        points = (corners @ view.R.T + view.t_m).astype(np.float32)
        draw(raster, camera, points, np.arange(len(points), dtype=np.int32).reshape(-1, 3))
    draw_planes(raster, camera, room, view)
    return raster.depth_m
