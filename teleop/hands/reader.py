"""Both hands of one frame, by the configured rule."""

from __future__ import annotations

from teleop.config.intent import HandConfig
from teleop.frames import DepthFrame
from teleop.hands import paper, shape
from teleop.hands.skin_model import SkinModel, face_skin, stored_skin
from teleop.intent_types import Hand, Hands
from teleop.skeleton import Skeleton


def read_hands(
    frame: DepthFrame, skeleton: Skeleton | None, config: HandConfig, skin: SkinModel | None = None
) -> Hands:
    """What both hands show in this frame alone; UNKNOWN without a skeleton. Joints in camera axes.

    skin: the operator's, remembered from the frames before; None: it is taken from the face in this one.
    """
    if skeleton is None:
        return Hands()
    if config.hand == "paper":
        right, right_confidence = paper.read_hand(frame, skeleton, "right", config)
        left, left_confidence = paper.read_hand(frame, skeleton, "left", config)
    else:
        skin = skin or stored_skin(config) or face_skin(frame, skeleton, config)
        right, right_confidence = shape.read_hand(frame, skeleton, "right", config, skin)
        left, left_confidence = shape.read_hand(frame, skeleton, "left", config, skin)
    return Hands(Hand(right), Hand(left), right_confidence, left_confidence)
