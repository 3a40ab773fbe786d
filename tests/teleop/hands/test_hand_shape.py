"""The better hand rule on the bundled recording, and what makes it answer unknown."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from stick_figure import Arm, Person, skeleton

from teleop.config.intent import HandConfig
from teleop.frames import Camera, DepthFrame, kinect_v1
from teleop.hands.reader import read_hands
from teleop.intent_types import Hand, Hands
from teleop.joints import JOINT_NAMES
from teleop.skeleton import Skeleton
from teleop.sources import open_source

RECORDING = Path(__file__).parents[3] / "recordings" / "greenhouse_demo.mcap"
TRUTH = RECORDING.with_suffix(".truth.jsonl")
CONFIG = HandConfig()


@cache
def recorded() -> tuple[tuple[DepthFrame, Skeleton, dict[str, str]], ...]:
    """Every sixth frame of the recording with the true joints, as the tracker would leave them, and the true hands."""
    if not (RECORDING.exists() and TRUTH.exists()):
        pytest.skip("the bundled recording is not there; make it with python -m teleop.people.demo_recording")
    rng = np.random.default_rng(2)
    source, out = open_source(str(RECORDING)), []
    for i, (frame, line) in enumerate(zip(source.frames(), TRUTH.read_text().splitlines(), strict=True)):
        row = json.loads(line)
        if i % 6 or not row["seen"]:
            continue
        joints = np.array([row["joints"][name] or [np.nan] * 3 for name in JOINT_NAMES], dtype=float)
        body = Skeleton(frame.t_ns, joints + rng.normal(0, 0.012, joints.shape), np.ones(20))
        out.append((frame, body, row["hands"]))
    source.close()
    return tuple(out)


def score(config: HandConfig, color: bool) -> tuple[float, float, float]:
    """Share decided, share right of those, share right of all."""
    right = decided = shown = 0
    for frame, body, truth in recorded():
        seen = read_hands(frame if color else frame.without_color(), body, config)
        for side, answer in (("right", seen.right), ("left", seen.left)):
            if truth[side] == "unknown":
                continue
            shown += 1
            decided += answer is not Hand.UNKNOWN
            right += answer == truth[side]
    return decided / shown, right / max(1, decided), right / shown


@pytest.mark.parametrize("color", [True, False])
def test_recorded_hands_are_read_right(color: bool) -> None:
    decided, right, _ = score(CONFIG, color)
    assert decided >= 0.85
    assert right >= 0.95


def test_shape_beats_the_sources_rule_on_the_same_frames() -> None:
    shape = score(CONFIG, True)[2]
    assert shape > score(HandConfig(hand="paper"), True)[2]
    assert shape > score(HandConfig(hand="paper", ratio=0.8), True)[2]


def plate(person: Person, side_m: float) -> DepthFrame:
    """A wall with a square plate where the right hand is."""
    camera = Camera(kinect_v1())
    body = skeleton(person)
    hand = body.joint("hand_right")
    assert hand is not None
    k = camera.depth
    u, v = k.cx - k.fx * hand[0] / hand[2], k.cy - k.fy * hand[1] / hand[2]
    half = round(side_m * k.fx / hand[2] / 2)
    depth = np.full((480, 640), 3800, np.uint16)
    depth[round(v) - half : round(v) + half, round(u) - half : round(u) + half] = round(hand[2] * 1000)
    return DepthFrame(0, depth, camera)


def test_unknown_when_the_palm_cannot_be_seen() -> None:
    towards = Person(right=Arm((1.0, 0.0, 0.05), (1.0, 0.0, 0.05)))
    assert read_hands(plate(towards, 0.12), skeleton(towards), CONFIG).right is Hand.UNKNOWN
    aside = Person(right=Arm((0.0, 0.7, -0.7), (0.0, 0.7, 0.7)))
    assert read_hands(plate(aside, 0.01), skeleton(aside), CONFIG).right is Hand.UNKNOWN, "too few pixels"
    doubtful = skeleton(aside)
    doubtful.confidence[:] = 0.0
    assert read_hands(plate(aside, 0.12), doubtful, CONFIG).right is Hand.UNKNOWN
    assert read_hands(plate(aside, 0.12), None, CONFIG) == Hands()


def test_a_hand_off_the_picture_is_unknown() -> None:
    away = skeleton(Person(x=2.5))
    assert read_hands(plate(Person(), 0.12), away, CONFIG) == Hands()


def test_undecided_is_unknown() -> None:
    frame, body, _ = recorded()[0]
    assert read_hands(frame, body, replace_margin(10.0)) == Hands()


def replace_margin(margin: float) -> HandConfig:
    return CONFIG.model_copy(update={"decide_margin": margin})


def test_skin_coloured_walls_and_shirts_do_not_mislead() -> None:
    """The same hand before a wall of its own colour: depth tells them apart."""
    frame, body, _ = next(row for row in recorded() if row[2]["right"] == "open")
    color = frame.color_rgb
    assert color is not None
    hand = body.joint("hand_right")
    assert hand is not None
    painted = color.copy()
    painted[(frame.depth_mm > 1000 * hand[2] + 250) | (frame.depth_mm == 0)] = (205, 160, 132)
    before = read_hands(frame, body, CONFIG)
    after = read_hands(replace(frame, color_rgb=painted, color_jpeg=None), body, CONFIG)
    assert before.right is Hand.OPEN and after.right is Hand.OPEN
