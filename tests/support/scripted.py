"""A pipeline whose perception is a script of people, everything behind it being the real one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from stick_figure import Person, frame, skeleton

from teleop.assist.task import RobotView
from teleop.config import TeleopConfig
from teleop.config.intent import HandConfig
from teleop.frames import DepthFrame
from teleop.hands.skin_model import SkinModel
from teleop.inputs import Inputs
from teleop.intent_types import Hands
from teleop.pipeline import Pipeline, PipelineOutput, PipelineState
from teleop.skeleton import Skeleton, Track

PERIOD_NS = 33_333_333


class ScriptedTracker:
    """Takes the skeleton of frame number ``seq`` from a list; stands where the body tracker stands."""

    def __init__(self) -> None:
        self.skeletons: dict[int, Skeleton | None] = {}
        self.resets: set[int] = set()
        self.hands: dict[int, Hands] = {}

    def initial_state(self) -> None:
        return None

    def step(self, frame: DepthFrame, state: None) -> tuple[Track, None]:
        body = self.skeletons.get(frame.seq)
        return Track(frame.t_ns, body, None, None, None, None, frame.seq in self.resets), None

    def read_hands(
        self, frame: DepthFrame, skeleton: Skeleton | None, _config: HandConfig, _skin: SkinModel | None = None
    ) -> Hands:
        """What the person in the script shows; nothing without a skeleton, as the real rule."""
        return Hands() if skeleton is None else self.hands.get(frame.seq, Hands())


@dataclass
class Rig:
    """Drives a pipeline frame by frame with people, or skeletons, or nobody."""

    tracker: ScriptedTracker
    pipeline: Pipeline
    state: PipelineState
    t_ns: int = 0
    seq: int = 0
    rng: np.random.Generator | None = None
    robot: RobotView | None = None

    def show(
        self, who: Person | Skeleton | None, inputs: Inputs = Inputs(), dt_ns: int = PERIOD_NS, reset: bool = False
    ) -> PipelineOutput:
        """One frame later."""
        self.t_ns += dt_ns
        self.seq += 1
        self.tracker.skeletons[self.seq] = skeleton(who, self.t_ns, self.rng) if isinstance(who, Person) else who
        if isinstance(who, Person):
            self.tracker.hands[self.seq] = who.hands
        if reset:
            self.tracker.resets.add(self.seq)
        return self.push(frame(self.t_ns, self.seq), inputs)

    def push(self, picture: DepthFrame, inputs: Inputs = Inputs()) -> PipelineOutput:
        """This very frame."""
        output, self.state = self.pipeline.step(picture, self.state, inputs, self.robot)
        return output

    def hold(self, who: Person | Skeleton | None, seconds: float) -> list[PipelineOutput]:
        """The same for a while."""
        return [self.show(who) for _ in range(round(seconds * 30))]

    def until(self, who: Person | None, seconds: float) -> Iterator[tuple[float, PipelineOutput]]:
        """The same for a while, with the time since the first frame of it."""
        for i in range(round(seconds * 30)):
            yield (i + 1) / 30, self.show(who)


def rig(config: TeleopConfig | None = None, assume_engaged: bool = False) -> Rig:
    """A fresh pipeline."""
    tracker = ScriptedTracker()
    pipeline = Pipeline(tracker, config or TeleopConfig(), tracker.read_hands)  # type: ignore[arg-type]
    return Rig(tracker, pipeline, pipeline.initial_state(assume_engaged))


def engaged(config: TeleopConfig | None = None, person: Person | None = None) -> Rig:
    """A pipeline with an operator in control, engaged by request, settled where the person stands."""
    r = rig(config)
    person = person or Person()
    r.hold(person, 0.5)
    r.show(person, Inputs(engage=True))
    r.hold(person, 1.0)
    return r
