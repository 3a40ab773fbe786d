"""What every configuration section shares: frozen, no unknown keys, every number described with its unit."""

from pydantic import BaseModel, ConfigDict


class Section(BaseModel):
    """A frozen section of the one configuration tree; an unknown key or a value out of range is refused."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)
