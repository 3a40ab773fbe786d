"""One line of the table of ``teleop doctor``."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Status(StrEnum):
    """ok; missing: only what is optional is absent; failed: a basic does not work."""

    OK = "ok"
    MISSING = "missing"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class Check:
    """What was looked at, how it is, what to do."""

    name: str
    status: Status
    found: str
    next_step: str = ""
