"""What ``teleop doctor`` says about serving."""

from __future__ import annotations

from pathlib import Path

import pytest

from server.access.tokens import load_tokens
from server.cli.check import Status
from server.cli.service_checks import library_check, service, tokens_check
from server.settings import Settings


def settings(**given: object) -> Settings:
    return Settings.model_validate(given)


def test_tokens_are_missing_kept_or_damaged(tmp_path: Path) -> None:
    path = tmp_path / "access.json"
    given = settings(access={"file": str(path)})
    assert tokens_check(given).status is Status.MISSING and not path.exists()
    load_tokens(path)
    assert tokens_check(given).status is Status.OK
    path.write_text("{}")
    damaged = tokens_check(given)
    assert damaged.status is Status.FAILED and "--new-tokens" in damaged.next_step


def test_recordings_need_room_in_a_folder_that_can_be_written(tmp_path: Path) -> None:
    assert library_check(settings(library=str(tmp_path / "new" / "deep"))).status is Status.OK
    assert list(tmp_path.iterdir()) == [], "nothing is left behind"
    full = library_check(settings(library=str(tmp_path), engine={"min_disk_mb": 1_000_000}))
    assert full.status in (Status.MISSING, Status.OK)
    assert library_check(settings(library="/proc/none")).status is Status.FAILED


def test_a_wrong_variable_is_one_failed_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TELEOP_PORT", "99999")
    (line,) = service()
    assert line.status is Status.FAILED and "1 <= value <= 65535" in line.found
