"""The one configuration tree of teleop: perception, then intent. Loaded by the server from TOML, environment, API."""

from __future__ import annotations

from pydantic import Field

from teleop.config.base import Section
from teleop.config.body import BodyConfig
from teleop.config.intent import IntentConfig

__all__ = ["BodyConfig", "IntentConfig", "TeleopConfig"]


class TeleopConfig(Section):
    """Everything between a depth frame and a robot command."""

    body: BodyConfig = Field(default_factory=BodyConfig)
    intent: IntentConfig = Field(default_factory=IntentConfig)
