"""The one configuration tree of teleop: perception, then intent. Loaded by the server from TOML, environment, API."""

from __future__ import annotations

from typing import Any, Self

from pydantic import Field, ValidationError, model_validator

from teleop.config.base import Section
from teleop.config.body import BodyConfig
from teleop.config.intent import IntentConfig
from teleop.config.operator import OperatorConfig

__all__ = ["BodyConfig", "IntentConfig", "OperatorConfig", "TeleopConfig"]


class TeleopConfig(Section):
    """Everything between a depth frame and a robot command."""

    body: BodyConfig = Field(default_factory=BodyConfig)
    intent: IntentConfig = Field(default_factory=IntentConfig)
    operator: OperatorConfig = Field(default_factory=OperatorConfig)

    def effective_intent(self) -> IntentConfig:
        """Intent with the chosen operator's values laid over it."""
        own = self.operator
        patch: dict[str, dict[str, Any]] = {}
        if own.handedness is not None:
            patch.setdefault("mapping", {})["handedness"] = own.handedness
        if own.skin is not None:
            patch.setdefault("hands", {})["skin"] = own.skin
        if own.bones_m:
            patch["bones"] = {f"{bone}_m": length_m for bone, length_m in own.bones_m.items()}
            patch["bones"]["tolerance"] = min(self.intent.bones.tolerance, own.bone_tolerance)
        for path, value in own.thresholds.items():
            section, name = path.split(".")
            patch.setdefault(section, {})[name] = value
        if not patch:
            return self.intent
        tree = self.intent.model_dump(mode="python")
        for section, values in patch.items():
            tree[section] |= values
        return IntentConfig.model_validate(tree)

    @model_validator(mode="after")
    def _operator_fits(self) -> Self:
        try:
            self.effective_intent()
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            path = ".".join(str(part) for part in first["loc"])
            raise ValueError(f"operator: {path}: {first['msg']} (got {first['input']!r})") from None
        return self
