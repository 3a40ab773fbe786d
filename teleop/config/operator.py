"""What belongs to one operator: handedness, bone lengths, skin, thresholds of their own."""

from __future__ import annotations

from typing import Annotated, Final, Literal, Self

from annotated_types import Len
from pydantic import Field, model_validator

from teleop.config.base import Section

BONES: Final = ("upper_arm", "forearm", "trunk", "thigh", "shin")
NAME_PATTERN: Final = r"^$|^[A-Za-z0-9][A-Za-z0-9 ._-]{0,39}$"
OPEN_SECTIONS: Final = ("zones", "task", "angles", "mapping", "drive", "hands", "engage", "level")
"""Sections of intent that a profile may have values for; safety is nobody's own."""


class OperatorConfig(Section):
    """The chosen operator's own values; they are laid over all other settings of intent."""

    name: str = Field(default="", pattern=NAME_PATTERN, description="the operator's name; empty: nobody is chosen")
    handedness: Literal["right", "left"] | None = Field(
        default=None, description="left swaps the roles of arms and hands; null leaves intent.mapping.handedness"
    )
    bones_m: dict[str, float] = Field(
        default_factory=dict, description="bone lengths [m]: upper_arm, forearm, trunk, thigh, shin; measured"
    )
    bone_tolerance: float = Field(
        default=0.35, ge=0.1, le=2.0, description="as intent.bones.tolerance, for bones that were measured [1]; ours"
    )
    skin: Annotated[tuple[float, ...], Len(5, 5)] | None = Field(
        default=None, description="mean Cb, mean Cr, variance of Cb, covariance, variance of Cr; learned from the face"
    )
    thresholds: dict[str, float] = Field(
        default_factory=dict, description="numbers of intent by their path, such as task.T1_deg; none of safety"
    )

    @model_validator(mode="after")
    def _legal(self) -> Self:
        for bone, length_m in self.bones_m.items():
            if bone not in BONES:
                raise ValueError(f"bones_m: no bone '{bone}'; legal: {', '.join(BONES)}")
            if not 0.1 <= length_m <= 1.2:
                raise ValueError(f"bones_m.{bone} must lie in 0.1..1.2 m, got {length_m:g}")
        for path in self.thresholds:
            if path.split(".")[0] not in OPEN_SECTIONS or path.count(".") != 1:
                raise ValueError(f"thresholds: '{path}' is none; legal: SECTION.NAME of {', '.join(OPEN_SECTIONS)}")
        return self
