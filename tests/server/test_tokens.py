"""Tokens are kept as digests only; cookies are signed, age, and end with their tokens."""

from __future__ import annotations

from pathlib import Path

import pytest

from server.access.rates import Rates
from server.access.roles import Role
from server.access.tokens import load_tokens, new_tokens
from server.errors import SettingsError


def test_tokens_are_shown_once_and_kept_as_digests(tmp_path: Path) -> None:
    path = tmp_path / "keys" / "access.json"
    first, shown = load_tokens(path)
    assert set(shown) == set(Role) and len(set(shown.values())) == 3
    assert path.stat().st_mode & 0o777 == 0o600
    assert not any(token in path.read_text() for token in shown.values())
    again, nothing = load_tokens(path)
    assert nothing == {} and again == first
    assert all(again.role_of(token) is role for role, token in shown.items())
    assert again.role_of("gt_operator_wrong") is None and again.role_of("") is None


def test_new_tokens_end_the_old_ones_and_their_logins(tmp_path: Path) -> None:
    path = tmp_path / "access.json"
    old, shown = load_tokens(path)
    cookie = old.cookie(Role.OPERATOR, until_s=100.0)
    new, _ = load_tokens(path, renew=True)
    assert new.role_of(shown[Role.OPERATOR]) is None
    assert old.role_of_cookie(cookie, now_s=99.0) is Role.OPERATOR and new.role_of_cookie(cookie, now_s=99.0) is None


def test_a_cookie_ages_and_cannot_be_made_up() -> None:
    tokens, _ = new_tokens()
    cookie = tokens.cookie(Role.VIEWER, until_s=100.0)
    assert tokens.role_of_cookie(cookie, now_s=100.0) is None
    assert tokens.role_of_cookie(cookie.replace("viewer", "supervisor"), now_s=1.0) is None
    assert tokens.role_of_cookie(cookie.replace("100", "999"), now_s=1.0) is None
    for text in ("", ".", "..", "viewer.100.", "nobody.1.ff", "\x00"):
        assert tokens.role_of_cookie(text, now_s=1.0) is None


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"digests": {}, "signing_key": "zz"}'])
def test_a_damaged_file_is_one_line_with_the_next_step(tmp_path: Path, text: str) -> None:
    path = tmp_path / "access.json"
    path.write_text(text)
    path.chmod(0o600)
    with pytest.raises(SettingsError, match="--new-tokens"):
        load_tokens(path)


def test_a_file_that_others_can_read_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "access.json"
    load_tokens(path)
    path.chmod(0o644)
    with pytest.raises(SettingsError, match="chmod 600"):
        load_tokens(path)


def test_rates_refill_with_time_and_each_key_has_its_own() -> None:
    rates = Rates(per_s=2.0, burst=3)
    assert [rates.wait_s("a", 0.0) for _ in range(3)] == [0.0] * 3
    assert rates.wait_s("a", 0.0) == 0.5 and rates.wait_s("b", 0.0) == 0.0
    assert rates.wait_s("a", 0.5) == 0.0 and rates.wait_s("a", 0.5) > 0.0
    assert [rates.wait_s("a", 60.0) for _ in range(4)] == [0.0, 0.0, 0.0, 0.5], "never more than the burst"
    for i in range(5000):
        rates.wait_s(f"flood {i}", 60.0)
    assert rates.wait_s("b", 60.0) == 0.0
