"""A driven operator works through the whole chain, from rendered frames to commands: time is the frames' own."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config import TeleopConfig
from teleop.intent_types import Mode
from teleop.people.puppet import Puppet
from teleop.people.wishes import ArmWish, Wish
from teleop.pipeline import Pipeline, PipelineOutput
from teleop.sources.virtual_options import parse_options

FPS = 10
LONGEST_S = 12.0


class Acting:
    """The operator before the sensor, and what the pipeline makes of them."""

    def __init__(self) -> None:
        self.stage = parse_options(f"fps={FPS}").stage()
        config = TeleopConfig()
        self.pipeline = Pipeline(BodyTracker(load_model(), config.body), config)
        self.pipeline.tracker.warm_up(self.stage.camera)
        self.state = self.pipeline.initial_state()
        self.puppet = Puppet()
        self.number = 0
        self.reasons: set[str] = set()

    def until(self, wish: Wish, true: Callable[[PipelineOutput], bool]) -> PipelineOutput:
        """Act a wish until something is so."""
        for _ in range(round(LONGEST_S * FPS)):
            moment = self.puppet.step(wish, 1.0 / FPS)
            frame = self.stage.take(moment, self.number, round(self.number / FPS * 1e9)).frame
            output, self.state = self.pipeline.step(frame, self.state)
            self.number += 1
            self.reasons |= {str(event.reason) for event in output.events}
            if true(output):
                return output
        pytest.fail(f"it never came true: {output.intent.mode}, {output.command}")


def test_they_engage_pick_drive_and_stop_by_gesture() -> None:
    acting = Acting()
    acting.until(Wish(), lambda o: o.intent.mode is Mode.SEEN)
    acting.until(Wish(gesture="engage"), lambda o: o.intent.mode is not Mode.SEEN)
    assert "mode.engage_gesture" in acting.reasons
    raised = Wish(apart_deg=26.0, right=ArmWish(side_deg=60.0, elbow_deg=120.0))
    acting.until(raised, lambda o: o.command.right_arm is not None and o.command.right_arm.c2_deg >= 45.0)
    assert "mode.task_settled" in acting.reasons
    acting.until(Wish(z_m=1.65), lambda o: o.intent.mode is Mode.FORWARD and o.command.drive_m_s > 0)
    acting.until(Wish(gesture="stop"), lambda _: "stop.body" in acting.reasons)
