"""The better hand rule: the hand by depth and colour, turned upright and scaled, judged by a small network.

Unknown when geometry says that the palm cannot be seen (``legible``), and when the network is undecided. Without
colour it goes by depth alone.
"""

from __future__ import annotations

import math

import numpy as np

from teleop.config.intent import HandConfig
from teleop.frames import DepthFrame
from teleop.hands.aim import aim_at_hand
from teleop.hands.crop import color_at_depth
from teleop.hands.legible import illegible
from teleop.hands.network import LAYERS_OF, Sight, load_networks
from teleop.hands.patch import hand_depth_m, hand_patch
from teleop.hands.skin_model import SkinModel, generic_skin
from teleop.intent_types import Hand, Side
from teleop.joints import JOINT_INDEX
from teleop.skeleton import Skeleton


def open_logit(
    frame: DepthFrame, skeleton: Skeleton, side: Side, config: HandConfig, skin: SkinModel | None
) -> float | None:
    """Log odds of an open hand, calibrated; None when this hand cannot be read. skin: the operator's, if known."""
    aim = aim_at_hand(skeleton, side, frame.camera)
    if aim is None or illegible(frame, aim, config) is not None:
        return None
    z_m = hand_depth_m(frame, aim, config)
    if z_m is None:
        return None
    patch = hand_patch(frame, aim, z_m, skin or generic_skin(config))
    sight: Sight = "depth" if color_at_depth(frame) is None else "both"
    views = patch[None, ..., list(LAYERS_OF[sight])]
    # a hand and its mirror image are equally open: two looks err less than one
    both = np.concatenate([views, views[:, :, ::-1]])
    return float(load_networks()[sight].logit(both).mean())


def read_hand(
    frame: DepthFrame, skeleton: Skeleton, side: Side, config: HandConfig, skin: SkinModel | None = None
) -> tuple[Hand, float]:
    """OPEN, FIST or UNKNOWN with confidence 0..1, the network's probability of its answer."""
    if skeleton.confidence[JOINT_INDEX[f"hand_{side}"]] < config.min_confidence:
        return Hand.UNKNOWN, 0.0
    logit = open_logit(frame, skeleton, side, config, skin)
    if logit is None or abs(logit) < config.decide_margin:
        return Hand.UNKNOWN, 0.0
    return (Hand.OPEN if logit > 0 else Hand.FIST), 1.0 / (1.0 + math.exp(-abs(logit)))
