"""The robot's threads run before others where the system allows it, and the server starts where it does not."""

import os

import pytest

from server.runner import NICE, take_precedence


def test_priority_is_taken_where_it_is_allowed(monkeypatch: pytest.MonkeyPatch) -> None:
    taken: list[int] = []
    monkeypatch.setattr(os, "getpriority", lambda which, who: 0)
    monkeypatch.setattr(os, "setpriority", lambda which, who, nice: taken.append(nice))
    assert take_precedence()
    monkeypatch.setattr(os, "getpriority", lambda which, who: -10)
    assert take_precedence()
    assert taken == [NICE, -10]


def test_without_the_right_to_it_the_server_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(which: int, who: int, nice: int) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "setpriority", refused)
    assert not take_precedence()
