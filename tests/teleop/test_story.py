"""The bundled recording through the real tracker: what the operator did is what the robot was told."""

import json
from pathlib import Path

import pytest

from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config import TeleopConfig
from teleop.intent_types import Event
from teleop.pipeline import Pipeline
from teleop.sources import open_source

RECORDING = Path(__file__).parents[2] / "recordings" / "greenhouse_demo.mcap"
TRUTH = RECORDING.with_suffix(".truth.jsonl")
MAX_DELAY_S = 1.0
"""Longest time from a true change of mode to ours, the walking between zones included."""


@pytest.fixture(scope="module")
def told() -> list[tuple[dict, str, tuple[Event, ...]]]:
    """For every frame: the truth, our mode, our events; nobody is taken as engaged."""
    if not (RECORDING.exists() and TRUTH.exists()):
        pytest.skip("the bundled recording is not there; make it with python -m teleop.people.demo_recording")
    config = TeleopConfig()
    pipeline = Pipeline(BodyTracker(load_model(), config.body), config)
    state, source, out = pipeline.initial_state(), open_source(str(RECORDING)), []
    for frame, line in zip(source.frames(), TRUTH.read_text().splitlines(), strict=True):
        output, state = pipeline.step(frame, state)
        out.append((json.loads(line), str(output.intent.mode), output.events))
    source.close()
    return out


def in_order(wanted: list[str], found: list[str]) -> bool:
    rest = iter(found)
    return all(word in rest for word in wanted)


def test_modes_follow_the_story(told: list) -> None:
    modes = [event.detail.split(" -> ")[1] for _, _, events in told for event in events if event.kind == "mode"]
    story = ["seen", "engaged", "forward", "back", "right", "picking", "spraying", "seen", "no_person"]
    assert in_order(story, modes)
    assert "left" not in modes and "stopped" not in modes and "held" not in modes


def test_no_mode_differs_from_the_truth_for_long(told: list) -> None:
    since, differs = 0.0, 0
    before = None
    for truth, mode, _ in told:
        if truth["mode"] != before:
            before, since = truth["mode"], truth["t"]
        if truth["mode"] is not None and truth["t"] - since > MAX_DELAY_S:
            # while it is being decided the robot holds: that is late, but never wrong
            differs += mode not in (truth["mode"], "engaged")
    assert differs == 0


def test_tools_do_what_the_hands_told(told: list) -> None:
    tools = [event.reason for _, _, events in told for event in events if event.kind == "tool"]
    assert in_order(["tool.gripper_closed", "tool.cutter_closed", "tool.cutter_open", "tool.gripper_open"], tools)
    assert in_order(["tool.gripper_open", "tool.spray_on", "tool.liquid", "tool.spray_off"], tools)
    assert tools.count("tool.spray_on") == tools.count("tool.spray_off") == 1
