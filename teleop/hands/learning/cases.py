"""Hands of rendered people never seen in training, each read by every rule on the very same frame."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from teleop.body.tracker import BodyTracker
from teleop.config import BodyConfig
from teleop.config.intent import HandConfig
from teleop.frames import DepthFrame
from teleop.hands.aim import aim_at_hand
from teleop.hands.legible import illegible
from teleop.hands.reader import read_hands
from teleop.hands.shape import open_logit
from teleop.hands.skin_model import face_skin
from teleop.intent_types import Hand
from teleop.joints import JOINT_INDEX
from teleop.people.hand_shots import HandShot, hand_shots
from teleop.skeleton import Skeleton

Progress = Callable[[str, float], None]
NEAR_M, FAR_M = 1.4, 3.5
JOINT_NOISE_M: Final = 0.020
FIRST_SEED: Final = 100_000
_OTHER: Final = {"right": "hand_left", "left": "hand_right"}
RULES: Final = ("ours", "ours, depth alone", "source, ratio 0.33", "source, ratio 0.8")
JOINTS: Final = ("true joints, 20 mm noise", "tracker's joints")


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """One hand. truth: OPEN or FIST, whichever is nearer. answers: by (joints, rule). logit: ours, undecided ones
    included, None when geometry forbids a reading; illegible: why. The rest describes the hand, see HandShot; z_m: its
    distance; apart_m: from the other hand."""

    truth: Hand
    answers: dict[tuple[str, str], Hand]
    logit: float | None
    illegible: str | None
    tone: float
    light: float
    z_m: float
    palm_cos: float
    ray_cos: float
    skin_wall: bool
    before_body: bool
    curl: float = 0.0
    apart_m: float = 1.0


def _answers(frame: DepthFrame, body: Skeleton | None, side: str, config: HandConfig) -> dict[str, Hand]:
    def read(config: HandConfig, frame: DepthFrame) -> Hand:
        return getattr(read_hands(frame, body, config), side)

    return {
        "ours": read(config, frame),
        "ours, depth alone": read(config, frame.without_color()),
        "source, ratio 0.33": read(config.model_copy(update={"hand": "paper", "ratio": 0.33}), frame),
        "source, ratio 0.8": read(config.model_copy(update={"hand": "paper", "ratio": 0.8}), frame),
    }


def _case(shot: HandShot, noisy: Skeleton, tracked: Skeleton | None, config: HandConfig) -> Case:
    answers = {}
    for joints, body in zip(JOINTS, (noisy, tracked), strict=True):
        for rule, hand in _answers(shot.frame, body, shot.side, config).items():
            answers[joints, rule] = hand
    aim = aim_at_hand(noisy, shot.side, shot.frame.camera)
    hand = shot.joints_m[JOINT_INDEX[f"hand_{shot.side}"]]
    spine, head = shot.joints_m[JOINT_INDEX["spine"]], shot.joints_m[JOINT_INDEX["head"]]
    forearm = shot.joints_m[JOINT_INDEX[f"wrist_{shot.side}"]] - shot.joints_m[JOINT_INDEX[f"elbow_{shot.side}"]]
    beside = [abs(hand[0] - at[0]) < half and low < hand[1] - at[1] < high
              for at, half, low, high in ((spine, 0.2, -0.3, 0.4), (head, 0.12, -0.15, 0.15))]  # fmt: skip
    skin = face_skin(shot.frame, noisy, config)
    return Case(
        truth=Hand.OPEN if shot.curl < 0.5 else Hand.FIST,
        answers=answers,
        logit=open_logit(shot.frame, noisy, shot.side, config, skin),
        illegible="off_image" if aim is None else illegible(shot.frame, aim, config),
        tone=shot.tone,
        light=shot.light,
        z_m=float(hand[2]),
        palm_cos=shot.palm_cos,
        ray_cos=float(abs(forearm @ hand) / (np.linalg.norm(forearm) * np.linalg.norm(hand))),
        skin_wall=shot.skin_wall,
        before_body=any(beside),
        curl=shot.curl,
        apart_m=float(np.linalg.norm(hand - shot.joints_m[JOINT_INDEX[_OTHER[shot.side]]])),
    )


@dataclass(frozen=True, slots=True)
class Kind:
    """What kind of hands to render: bare and flat open or a fist; gloved; neither open nor a fist."""

    name: str
    gloves: float = 0.0
    between: float = 0.0


BARE: Final = Kind("bare hands")
GLOVED: Final = Kind("gloved hands", gloves=1.0)
BETWEEN: Final = Kind("half-closed hands", between=1.0)


def rendered_cases(
    people: int, tracker: BodyTracker | None, config: HandConfig, progress: Progress, kind: Kind = BARE
) -> list[Case]:
    """Hands of so many people of the test split, 1.4-3.5 m away, each frame by itself.

    tracker: None leaves the tracker's joints out (they answer UNKNOWN).
    """
    return list(_cases(people, tracker, config, progress, kind))


def single_frame_tracker_config() -> BodyConfig:
    """The body tracker without its temporal filter."""
    config = BodyConfig()
    return config.model_copy(update={"filter": config.filter.model_copy(update={"enabled": False})})


def _cases(
    people: int, tracker: BodyTracker | None, config: HandConfig, progress: Progress, kind: Kind
) -> Iterator[Case]:
    for number in range(people):
        rng = np.random.default_rng([number, 5])
        tracked: Skeleton | None = None
        noisy: Skeleton | None = None
        for shot in hand_shots(FIRST_SEED + number, "test", True, kind.gloves, kind.between):
            if not NEAR_M < shot.joints_m[JOINT_INDEX[f"hand_{shot.side}"], 2] < FAR_M:
                continue
            if noisy is None:
                noisy = Skeleton(0, shot.joints_m + rng.normal(0, JOINT_NOISE_M, (20, 3)), np.ones(20))
                if tracker is not None:
                    tracked = tracker.step(shot.frame, tracker.initial_state())[0].skeleton
            yield _case(shot, noisy, tracked, config)
        progress(f"rendered people, {kind.name}", (number + 1) / people)
