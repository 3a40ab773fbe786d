"""The better hand rule: the hand's own pixels by depth, cut at the wrist, judged by their shape.

Unknown when the forearm points along the ray (the palm hides behind itself), when too little of the hand is seen, and
when the classifier is undecided. Without colour it goes by depth alone.
"""

from __future__ import annotations

import math

from teleop.config.intent import HandConfig
from teleop.frames import DepthFrame
from teleop.hands.classifier import DEPTH_ONLY, WITH_COLOR
from teleop.hands.features import features, hand_mask
from teleop.hands.view import hand_view
from teleop.intent_types import Hand, Side
from teleop.joints import JOINT_INDEX
from teleop.skeleton import Skeleton


def read_hand(frame: DepthFrame, skeleton: Skeleton, side: Side, config: HandConfig) -> tuple[Hand, float]:
    """OPEN, FIST or UNKNOWN with confidence 0..1, the classifier's probability of its answer."""
    if skeleton.confidence[JOINT_INDEX[f"hand_{side}"]] < config.min_confidence:
        return Hand.UNKNOWN, 0.0
    view = hand_view(frame, skeleton, side, config)
    if view is None or view.ray_cos > config.max_ray_cos:
        return Hand.UNKNOWN, 0.0
    mask = hand_mask(view, config)
    if mask is None:
        return Hand.UNKNOWN, 0.0
    classifier = DEPTH_ONLY if view.color_rgb is None else WITH_COLOR
    logit = float(classifier.logit(features(view, mask, config)))
    if abs(logit) < config.decide_margin:
        return Hand.UNKNOWN, 0.0
    return (Hand.OPEN if logit > 0 else Hand.FIST), 1.0 / (1.0 + math.exp(-abs(logit)))
