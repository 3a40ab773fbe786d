"""A rendered operator, the whole perception and the robot in one loop, a frame at a time.

Rendered depth and colour go into ``Pipeline.step``, its command into the robot, what the console paints of both back
to the operator, late; nothing else connects them. Time is the frames' own.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Protocol, Self

from robot_sim.env import GreenhouseEnv, Info
from robot_sim.pick.plan import Scenery
from robot_sim.pick.surroundings import hard
from robot_sim.state import RobotState
from teleop.assist.task import RobotView
from teleop.frames import DepthFrame
from teleop.inputs import Inputs
from teleop.operator_model.body import Body, Posture, standing
from teleop.operator_model.console import ConsoleView, paint
from teleop.operator_model.eye import latest
from teleop.operator_model.traits import Traits
from teleop.people.motion import Moment
from teleop.people.performance import Stage
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


def play(stage: Stage, traits: Traits, mind: Mind, pipeline: Pipeline, env: GreenhouseEnv) -> Iterator[Beat]:
    """Beats until the caller has enough, one a period of env. The operator begins to act at t_s = 0."""
    observed, info = env.reset()
    body = standing(mind.posture, traits.pace, traits.seed)
    state: PipelineState = pipeline.initial_state()
    views: list[ConsoleView] = []
    number = 0
    period_s = env.period_s
    scenery, robot = Scenery(hard(env.world.scenery()), env.world.fruits), env.world.config
    while True:
        t_s = (number - _WARM_FRAMES) * period_s
        if t_s >= -1e-9:
            mind = mind.think(latest(views, t_s, traits.late_s), body, t_s)
            body = body.ask(mind.posture, t_s)
        moment, body = body.at(t_s)
        frame = stage.take(moment, number, round(number * period_s * 1e9)).frame
        known = RobotView(observed.robot, robot, scenery)
        output, state = pipeline.step(frame, state, Inputs(engage=number == _ENGAGE_FRAME), known)
        observed, _, _, _, info = env.step(output.command)
        views.append(paint(output, state.kernel.assist, observed.robot, env.world.wet_leaves(), t_s + period_s))
        yield Beat(t_s, frame, output, observed.robot, info, observed.coverage, mind, moment)
        number += 1
