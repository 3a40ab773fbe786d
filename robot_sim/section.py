"""What every section of the robot's configuration is."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class RobotSection(BaseModel):
    """A frozen section; an unknown key, an infinity or a value out of range is refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
