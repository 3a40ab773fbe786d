"""A person acting a motion before a sensor: frame number in, depth frame and truth out."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from teleop.frames import Camera, DepthFrame
from teleop.people.body import Body, skin
from teleop.people.clothes import Dressed
from teleop.people.motion import Moment, Motion
from teleop.people.pose import pose_rig
from teleop.people.rig import Floats
from teleop.people.room import Room
from teleop.people.scene import Figure, shoot, stand
from teleop.people.sensor import SensorModel, sense
from teleop.people.shade import Light
from teleop.people.view import View


@dataclass(frozen=True, slots=True, eq=False)
class Take:
    """One frame, the joints (20, 3) in camera axes that are true in it, and the moment of the motion."""

    frame: DepthFrame
    joints_m: Floats
    moment: Moment


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """Who acts where before which sensor: everything that stays the same from frame to frame. seed: of the noise."""

    body: Body
    worn: Dressed
    room: Room | None
    view: View
    camera: Camera
    light: Light | None = field(default_factory=Light)
    sensor: SensorModel = field(default_factory=SensorModel)
    seed: int = 0

    def take(self, moment: Moment, number: int, t_ns: int) -> Take:
        """One moment as frame ``number`` of that time; deterministic."""
        posed = pose_rig(self.body.rig, moment.pose)
        local = skin(self.body, posed, self.worn.vertices_m)
        placed = stand(posed, local, moment.x_m, moment.z_m, moment.turn)
        rng = np.random.default_rng([self.seed, number])
        figure = Figure(self.body, self.worn, moment.pose, placed)
        shot = shoot((figure,), self.room, self.view, self.camera, self.light, rng)
        depth = sense(shot.depth_m, self.camera, rng, self.sensor).depth_mm
        return Take(DepthFrame(t_ns, depth, self.camera, shot.color_rgb, number), shot.joints_m, moment)


@dataclass(frozen=True, slots=True, eq=False)
class Performance:
    """A motion acted on a stage, so many frames a second."""

    stage: Stage
    motion: Motion
    frames_per_s: float

    @property
    def camera(self) -> Camera:
        """The sensor's."""
        return self.stage.camera

    @property
    def view(self) -> View:
        """Where the sensor stands."""
        return self.stage.view

    @property
    def frame_count(self) -> int:
        """Frames from the first key to the last."""
        return int(self.motion.duration_s * self.frames_per_s) + 1

    def take(self, number: int) -> Take:
        """Frame ``number`` (0 is the first key); deterministic."""
        t_s = number / self.frames_per_s
        return self.stage.take(self.motion.at(t_s), number, round(t_s * 1e9))
