"""Every code that can reach the console has words in both languages; the wire types are the server's."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

import pytest
from console_server import ROOT

from robot_sim.events import RobotEventKind
from robot_sim.pick.run import Stage
from robot_sim.reasons import RobotReason
from server.settings import Settings
from server.wire_types import typescript
from teleop.reasons import Reason

KEY = re.compile(r'^  "([^"]+)": "', re.MULTILINE)
CODE = re.compile(r'"((?:hold|stop|refused|limit|mode|tool|source|config|recording|assist|pick)\.[a-z_]+)"')
LANGUAGES = ROOT / "web" / "src" / "i18n"


def codes_in_sources() -> set[str]:
    """Codes written where events are made, beside those of the two enumerations."""
    teleop = ROOT / "teleop"
    files = [*teleop.glob("*.py"), *(teleop / "assist").glob("*.py"), *(ROOT / "server").rglob("*.py")]
    return {code for file in files for code in CODE.findall(file.read_text(encoding="utf-8"))}


@pytest.mark.parametrize("language", ["en", "zh"])
def test_every_reason_has_words(language: str) -> None:
    keys = set(KEY.findall((LANGUAGES / f"{language}.ts").read_text(encoding="utf-8")))
    codes = {*map(str, Reason), *map(str, RobotReason), *codes_in_sources(), *(f"assist.{stage}" for stage in Stage)}
    codes |= {f"robot.{kind}" for kind in RobotEventKind}
    assert len(codes) > len(Reason)
    assert [code for code in sorted(codes) if f"reason.{code}" not in keys] == []


def test_chinese_settings_are_settings_and_few_are_without() -> None:
    words = set(
        re.findall(r'^  "([a-z_.0-9A-Z]+)": "', (LANGUAGES / "settings_zh.ts").read_text(encoding="utf-8"), re.M)
    )
    there = {path.removeprefix("teleop.") for path in leaves(Settings().teleop.model_dump(mode="json"), "teleop")}
    assert words - there == set()
    assert len(there - words) <= len(there) // 10, sorted(there - words)


def leaves(tree: dict[str, Any], path: str) -> Iterator[str]:
    """Paths of the settings that the form shows: no lists, nothing that is empty."""
    for key, value in tree.items():
        if isinstance(value, dict):
            yield from leaves(value, f"{path}.{key}")
        elif isinstance(value, bool | int | float | str):
            yield f"{path}.{key}"


def test_wire_types_are_generated_from_the_servers() -> None:
    assert (ROOT / "web" / "src" / "wire.ts").read_text(encoding="utf-8") == typescript()


def test_lock_file_is_complete_and_names_no_registry() -> None:
    """`npm ci` refuses a lock that lacks a platform's optional package, on every platform."""
    text = (ROOT / "web" / "package-lock.json").read_text(encoding="utf-8")
    assert "http" not in text
    packages = json.loads(text)["packages"]
    asked = {
        name
        for package in packages.values()
        for kind in ("dependencies", "devDependencies", "optionalDependencies")
        for name in package.get(kind, {})
    }
    assert [name for name in sorted(asked) if f"node_modules/{name}" not in packages] == []
