"""Turns a pydantic refusal into one line that names the setting, what was given and what is legal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo


def explain(error: ValidationError, model: type[BaseModel]) -> str:
    """All refusals of one validation, joined by "; ". ``model`` is the root that was validated."""
    return "; ".join(_line(item, model) for item in error.errors(include_url=False))


def _line(item: Mapping[str, Any], model: type[BaseModel]) -> str:
    path = [str(part) for part in item["loc"]]
    name = ".".join(path) or "settings"
    if item["type"] == "extra_forbidden":
        parent = _model_at(model, path[:-1])
        legal = ", ".join(sorted(parent.model_fields)) if parent else "none"
        return f"{name}: no such setting; legal here: {legal}"
    field = _field_at(model, path)
    given = "" if item["type"] == "missing" else f" (got {item['input']!r})"
    return f"{name}: {item['msg']}{given}{_legal(field)}"


def _legal(field: FieldInfo | None) -> str:
    """ " ; legal: 0 <= value <= 9: description" for a described field, else nothing."""
    if field is None:
        return ""
    low = next((f"{m.ge} <= " for m in field.metadata if hasattr(m, "ge")), None)
    low = low or next((f"{m.gt} < " for m in field.metadata if hasattr(m, "gt")), "")
    high = next((f" <= {m.le}" for m in field.metadata if hasattr(m, "le")), None)
    high = high or next((f" < {m.lt}" for m in field.metadata if hasattr(m, "lt")), "")
    bounds = f"legal: {low}value{high}" if low or high else ""
    text = ", ".join(part for part in (bounds, field.description or "") if part)
    return f"; {text}" if text else ""


def _field_at(model: type[BaseModel], path: list[str]) -> FieldInfo | None:
    parent = _model_at(model, path[:-1])
    return parent.model_fields.get(path[-1]) if parent and path else None


def _model_at(model: type[BaseModel], path: list[str]) -> type[BaseModel] | None:
    for part in path:
        field = model.model_fields.get(part)
        kind = field.annotation if field else None
        if not (isinstance(kind, type) and issubclass(kind, BaseModel)):
            return None
        model = kind
    return model
