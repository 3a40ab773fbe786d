"""How live sensors are treated."""

from __future__ import annotations

from pydantic import Field

from teleop.config.base import Section


class SensorConfig(Section):
    """Settings of live sources."""

    retry_s: float = Field(
        default=1.0, ge=0.1, le=60.0, description="wait between two tries to open a lost sensor again [s]"
    )
    give_up_s: float = Field(
        default=30.0, ge=1.0, le=3600.0, description="teleop record ends when a sensor stays away this long [s]"
    )
