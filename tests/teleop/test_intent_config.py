"""The configuration tree of intent: every number has a unit and an origin, a bad value names the legal range."""

import re
from collections.abc import Iterator

import pytest
from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from teleop.config.intent import IntentConfig


def fields(model: type[BaseModel], path: str = "") -> Iterator[tuple[str, FieldInfo]]:
    for name, field in model.model_fields.items():
        kind = field.annotation
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            yield from fields(kind, f"{path}{name}.")
        else:
            yield f"{path}{name}", field


NUMBERS = [(name, f) for name, f in fields(IntentConfig) if f.annotation in (int, float)]


@pytest.mark.parametrize(("name", "field"), NUMBERS, ids=[name for name, _ in NUMBERS])
def test_every_number_has_range_unit_and_origin(name: str, field: FieldInfo) -> None:
    bounds = {type(m).__name__ for m in field.metadata}
    assert bounds & {"Ge", "Gt"} and bounds & {"Le", "Lt"}, name
    described = field.description or ""
    unit = re.search(r"\[[^\]]+\]", described)
    origin = ";" in described
    assert (unit or field.annotation is int) and origin, f"{name}: {described}"


def test_a_bad_value_is_refused_with_the_rest_unchanged() -> None:
    with pytest.raises(ValidationError, match="less than or equal to 3"):
        IntentConfig.model_validate({"zones": {"dwell_s": 9.0}})
    with pytest.raises(ValidationError, match="no_frame_stop_s must be at least"):
        IntentConfig.model_validate({"safety": {"no_frame_hold_s": 0.4, "no_frame_stop_s": 0.3}})
    with pytest.raises(ValidationError, match="half the narrowest zone"):
        IntentConfig.model_validate({"zones": {"margin_m": 0.2, "l2_m": 0.3}})
