"""The work behind ``teleop operators learn``: a session through the tracker, bones and skin out."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from typing import Literal

from server.settings import Settings
from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config import OperatorConfig
from teleop.frames import DepthFrame
from teleop.hands.skin_model import SkinModel, step_skin
from teleop.profiles import learned_profile
from teleop.skeleton import Skeleton
from teleop.sources import open_source


def learn(
    name: str,
    uri: str,
    handedness: Literal["right", "left"] | None,
    frames: int,
    settings: Settings,
    advance: Callable[[DepthFrame], None],
) -> OperatorConfig:
    """The profile of the one person in a source. Raises TeleopError when the source or the person is not usable."""
    tracker = BodyTracker(load_model(settings.model), settings.teleop.body)
    state = tracker.initial_state()
    skeletons: list[Skeleton] = []
    skin: SkinModel | None = None
    hands = settings.teleop.intent.hands
    with closing(open_source(uri)) as source:
        for number, frame in enumerate(source.frames()):
            if number >= frames:
                break
            track, state = tracker.step(frame, state)
            if track.skeleton is not None:
                skeletons.append(track.skeleton)
                skin = step_skin(skin, frame, track.skeleton, hands)
            advance(frame)
    return learned_profile(name, skeletons, skin, handedness)
