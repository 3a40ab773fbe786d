"""Every code that can reach the console has words in both languages; the wire types are the server's."""

from __future__ import annotations

import re

import pytest
from console_server import ROOT

from robot_sim.reasons import RobotReason
from server.wire_types import typescript
from teleop.reasons import Reason

KEY = re.compile(r'^  "([^"]+)": "', re.MULTILINE)
LANGUAGES = ROOT / "web" / "src" / "i18n"


@pytest.mark.parametrize("language", ["en", "zh"])
def test_every_reason_has_words(language: str) -> None:
    keys = set(KEY.findall((LANGUAGES / f"{language}.ts").read_text(encoding="utf-8")))
    codes = [*map(str, Reason), *map(str, RobotReason)]
    assert [code for code in codes if f"reason.{code}" not in keys] == []


def test_wire_types_are_generated_from_the_servers() -> None:
    assert (ROOT / "web" / "src" / "wire.ts").read_text(encoding="utf-8") == typescript()


def test_lock_file_names_no_registry() -> None:
    assert "http" not in (ROOT / "web" / "package-lock.json").read_text(encoding="utf-8")
