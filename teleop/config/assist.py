"""Configuration of the operator's side of the assisted pick."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from teleop.config.base import Section


class AssistConfig(Section):
    """Pointing at a fruit, confirming with the left fist, and taking over."""

    pointing: Literal["on", "off"] = Field(
        default="on",
        description="a hand beside the head: the other arm points at a fruit; off: console and API only",
    )
    aim_s: float = Field(
        default=0.8, ge=0.1, le=5.0, description="pointing at the same fruit this long opens its preview [s]; ours"
    )
    aim_begin_s: float = Field(
        default=0.2, ge=0.0, le=2.0, description="the hand is beside the head this long before arms hold [s]; ours"
    )
    cone_deg: float = Field(
        default=16.0, ge=2.0, le=45.0, description="a fruit this far off the arm's line is meant [deg]; ours"
    )
    keep_deg: float = Field(
        default=4.0,
        ge=0.0,
        le=20.0,
        description="another fruit must be this much nearer to the line [deg]; tracker error",
    )
    smoothing_s: float = Field(
        default=0.2, ge=0.0, le=2.0, description="time constant of the pointing direction [s]; joint noise"
    )
    straight_deg: float = Field(
        default=140.0, ge=90.0, le=180.0, description="an elbow bent more than this does not point [deg]; ours"
    )
    far_m: float = Field(default=1.6, ge=0.3, le=5.0, description="fruit further from the robot is not meant [m]; ours")
    preview_s: float = Field(
        default=30.0, ge=1.0, le=600.0, description="a preview that nobody confirms closes after this [s]; ours"
    )
    unknown_s: float = Field(
        default=2.0, ge=0.1, le=10.0, description="hands unread for so long end the pick [s]; ours"
    )
