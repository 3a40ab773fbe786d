"""What a virtual operator is told to do, and what may be changed of it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

Gesture = Literal["none", "engage", "stop"]
Hand = Literal["open", "relaxed", "fist"]


@dataclass(frozen=True, slots=True)
class ArmWish:
    """How an arm is held: projected angles theta1 (side), theta2 (front), inner angle theta3 of the elbow [deg]."""

    side_deg: float = 0.0
    front_deg: float = 0.0
    elbow_deg: float = 170.0
    hand: Hand = "relaxed"


@dataclass(frozen=True, slots=True)
class Wish:
    """What the operator shall do. x, z: place on the floor, skeleton space [m]. turn: to the operator's left [deg].

    apart: angle between the thighs (T1) [deg]. gesture: both arms for engaging (hands beside the head) or for the
    body stop (forearms crossed), whatever the arms are told.
    """

    x_m: float = 0.0
    z_m: float = 2.35
    turn_deg: float = 0.0
    apart_deg: float = 3.0
    right: ArmWish = field(default_factory=ArmWish)
    left: ArmWish = field(default_factory=ArmWish)
    gesture: Gesture = "none"


class ArmChange(BaseModel):
    """What changes of an arm; see :class:`ArmWish`."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)
    side_deg: float | None = Field(None, ge=0.0, le=110.0, description="upper arm raised to the side, theta1 [deg]")
    front_deg: float | None = Field(None, ge=0.0, le=88.0, description="upper arm raised to the front, theta2 [deg]")
    elbow_deg: float | None = Field(None, ge=30.0, le=180.0, description="inner angle, 180 straight, theta3 [deg]")
    hand: Hand | None = None

    def of(self, arm: ArmWish) -> ArmWish:
        """The arm with the change made."""
        return replace(arm, **self.model_dump(exclude_none=True))


class WishChange(BaseModel):
    """What changes of a virtual operator; what is left out stays. Every value has a person's range."""

    model_config = ConfigDict(
        extra="forbid",
        allow_inf_nan=False,
        frozen=True,
        json_schema_extra={"examples": [{"gesture": "engage"}, {"z_m": 2.3, "right": {"side_deg": 60.0}}]},
    )
    x_m: float | None = Field(None, ge=-2.5, le=2.5, description="place on the floor, operator's right positive [m]")
    z_m: float | None = Field(None, ge=1.0, le=4.5, description="distance from the sensor [m]")
    turn_deg: float | None = Field(None, ge=-90.0, le=90.0, description="turned to the operator's left [deg]")
    apart_deg: float | None = Field(None, ge=0.0, le=50.0, description="angle between the thighs, T1 [deg]")
    right: ArmChange | None = None
    left: ArmChange | None = None
    gesture: Gesture | None = Field(None, description="engage: hands beside the head; stop: forearms crossed")

    def of(self, wish: Wish) -> Wish:
        """The wish with the change made."""
        plain: dict[str, Any] = self.model_dump(exclude_none=True, exclude={"right", "left"})
        right, left = self.right or ArmChange(), self.left or ArmChange()
        return replace(wish, **plain, right=right.of(wish.right), left=left.of(wish.left))
