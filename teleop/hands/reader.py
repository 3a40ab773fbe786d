"""Both hands of one frame, by the configured rule."""

from __future__ import annotations

from teleop.config.intent import HandConfig
from teleop.frames import DepthFrame
from teleop.hands import paper, shape
from teleop.intent_types import Hand, Hands
from teleop.skeleton import Skeleton


def read_hands(frame: DepthFrame, skeleton: Skeleton | None, config: HandConfig, _skin: object = None) -> Hands:
    """What both hands show in this frame alone; UNKNOWN without a skeleton. Joints in camera axes."""
    if skeleton is None:
        return Hands()
    rule = paper.read_hand if config.hand == "paper" else shape.read_hand
    right, right_confidence = rule(frame, skeleton, "right", config)
    left, left_confidence = rule(frame, skeleton, "left", config)
    return Hands(Hand(right), Hand(left), right_confidence, left_confidence)
