"""The source's hand rule: skin area over crop area (source eq. 22, 23; specification, section 5).

The source decides at 0.8. On rendered hands that is at chance (an open hand fills 45 % of the crop), so the default
of ``ratio`` is a calibrated 0.33; set it to 0.8 for the documented original.
"""

from __future__ import annotations

from teleop.config.intent import HandConfig
from teleop.frames import DepthFrame
from teleop.hands.crop import color_pixel, square
from teleop.hands.skin import cleaned, skin_mask
from teleop.intent_types import Hand, Side
from teleop.skeleton import Skeleton


def skin_ratio(frame: DepthFrame, skeleton: Skeleton, side: Side, config: HandConfig) -> float | None:
    """Skin area over crop area round one hand, 0..1; None without colour, hand, or a crop inside the image."""
    hand, color = skeleton.joint(f"hand_{side}"), frame.color_rgb
    if hand is None or color is None:
        return None
    height, width = color.shape[:2]
    pixel = color_pixel(hand, frame.camera, width, height)
    if pixel is None:
        return None
    crop = square(color, pixel.u, pixel.v, max(3, round(config.crop_px * width / 640)))
    return None if crop is None else float(cleaned(skin_mask(crop, config)).mean())


def read_hand(frame: DepthFrame, skeleton: Skeleton, side: Side, config: HandConfig) -> tuple[Hand, float]:
    """OPEN above the ratio, FIST below, with confidence growing with the distance from it."""
    ratio = skin_ratio(frame, skeleton, side, config)
    if ratio is None:
        return Hand.UNKNOWN, 0.0
    confidence = min(1.0, 0.5 + 2.0 * abs(ratio - config.ratio))
    return (Hand.OPEN if ratio > config.ratio else Hand.FIST), confidence
