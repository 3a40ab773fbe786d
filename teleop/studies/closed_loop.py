"""A rendered operator, the whole perception and the robot in one loop, a frame at a time.

Rendered depth and colour go into ``Pipeline.step``, its command into the robot, what the console paints of both back
to the operator, late; nothing else connects them. Time is the frames' own.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Protocol, Self

import numpy as np

from robot_sim.env import GreenhouseEnv, Info
from robot_sim.state import RobotState
from teleop.evaluation.cases import Person
from teleop.frames import Camera, DepthFrame
from teleop.inputs import Inputs
from teleop.operator.body import Body, Posture, standing
from teleop.operator.console import ConsoleView, paint
from teleop.operator.eye import latest
from teleop.operator.traits import Traits
from teleop.people.body import skin
from teleop.people.motion import Moment
from teleop.people.pose import pose_rig
from teleop.people.room import Room
from teleop.people.scene import Figure, shoot, stand
from teleop.people.sensor import sense
from teleop.people.shade import Light
from teleop.people.view import View
from teleop.pipeline import Pipeline, PipelineOutput, PipelineState

_ENGAGE_FRAME: Final = 10
_WARM_FRAMES: Final = 45
"""The operator is seen, the button engages them, the task settles: 1.5 s before the word go."""


class Mind(Protocol):
    """What decides: a posture wanted now, what it is for, how many steps were taken; and the next mind."""

    @property
    def posture(self) -> Posture: ...

    @property
    def stage(self) -> str: ...

    @property
    def steps(self) -> int: ...

    def think(self, view: ConsoleView | None, body: Body, t_s: float) -> Self: ...


@dataclass(frozen=True, slots=True, eq=False)
class Booth:
    """Where the operator stands before which sensor. seed: of the sensor's noise."""

    person: Person
    room: Room
    view: View
    camera: Camera
    frames_per_s: float
    seed: int

    def frame(self, moment: Moment, number: int, t_s: float) -> DepthFrame:
        """What the sensor reads of the operator at a moment."""
        body, worn = self.person.body, self.person.worn
        posed = pose_rig(body.rig, moment.pose)
        placed = stand(posed, skin(body, posed, worn.vertices_m), moment.x_m, moment.z_m, moment.turn)
        rng = np.random.default_rng([self.seed, number])
        shot = shoot((Figure(body, worn, moment.pose, placed),), self.room, self.view, self.camera, Light(), rng)
        depth_mm = sense(shot.depth_m, self.camera, rng).depth_mm
        return DepthFrame(round(t_s * 1e9), depth_mm, self.camera, shot.color_rgb, number)


@dataclass(frozen=True, slots=True, eq=False)
class Beat:
    """One frame of the session. t_s: since the word go, negative before it. robot: after this frame's command."""

    t_s: float
    frame: DepthFrame
    output: PipelineOutput
    robot: RobotState
    info: Info
    coverage: float
    mind: Mind
    moment: Moment


def play(booth: Booth, traits: Traits, mind: Mind, pipeline: Pipeline, env: GreenhouseEnv) -> Iterator[Beat]:
    """Beats until the caller has enough. The robot starts anew; the operator begins to act at t_s = 0."""
    observed, info = env.reset()
    body = standing(mind.posture, traits.pace, traits.seed)
    state: PipelineState = pipeline.initial_state()
    views: list[ConsoleView] = []
    number = 0
    period_s = 1.0 / booth.frames_per_s
    while True:
        t_s = (number - _WARM_FRAMES) * period_s
        if t_s >= -1e-9:
            mind = mind.think(latest(views, t_s, traits.late_s), body, t_s)
            body = body.ask(mind.posture, t_s)
        moment, body = body.at(t_s)
        frame = booth.frame(moment, number, number * period_s)
        output, state = pipeline.step(frame, state, Inputs(engage=number == _ENGAGE_FRAME))
        observed, _, _, _, info = env.step(output.command)
        views.append(paint(output, observed.robot, env.world.wet_leaves(), t_s + period_s))
        yield Beat(t_s, frame, output, observed.robot, info, observed.coverage, mind, moment)
        number += 1
