"""Tokens of the three roles: made at the first start, shown once, kept as digests; and the cookies of logins.

A token has 256 random bits, so one round of SHA-256 keeps it as well as a slow hash keeps a password.
"""

from __future__ import annotations

import hashlib
import hmac
import json
import os
import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from server.access.roles import Role
from server.errors import SettingsError

_PREFIX = "gt"


@dataclass(frozen=True, slots=True)
class Tokens:
    """What the server knows: digests by role, and the key that signs the cookies of logins."""

    digests: Mapping[Role, str]
    signing_key: bytes

    def role_of(self, token: str) -> Role | None:
        """The role of a token, None for a wrong one. Takes the same time for each."""
        found = None
        digest = _digest(token)
        for role, known in self.digests.items():
            if hmac.compare_digest(known, digest):
                found = role
        return found

    def cookie(self, role: Role, until_s: float) -> str:
        """What a browser keeps instead of the token, good until that Unix time; new tokens make it void."""
        text = f"{role.label}.{int(until_s)}"
        return f"{text}.{self._signature(text)}"

    def role_of_cookie(self, cookie: str, now_s: float) -> Role | None:
        """The role of a cookie that :meth:`cookie` made, None when it is not one or too old."""
        text, _, signature = cookie.rpartition(".")
        if not hmac.compare_digest(self._signature(text), signature):
            return None
        label, _, until = text.partition(".")
        return Role[label.upper()] if now_s < int(until) else None

    def _signature(self, text: str) -> str:
        return hmac.new(self.signing_key, text.encode(), hashlib.sha256).hexdigest()


def new_tokens() -> tuple[Tokens, dict[Role, str]]:
    """Fresh tokens: what to keep, and what to show once."""
    shown = {role: f"{_PREFIX}_{role.label}_{secrets.token_urlsafe(32)}" for role in Role}
    return Tokens({role: _digest(token) for role, token in shown.items()}, secrets.token_bytes(32)), shown


def load_tokens(path: Path, renew: bool = False) -> tuple[Tokens, dict[Role, str]]:
    """The tokens kept in a file; made, and returned in words, when there are none yet or they are to be renewed.

    Raises SettingsError when the file is damaged, can be read by others or cannot be written.
    """
    if not renew and path.exists():
        return _read(path), {}
    tokens, shown = new_tokens()
    kept = {"digests": {r.label: d for r, d in tokens.digests.items()}, "signing_key": tokens.signing_key.hex()}
    part = path.with_suffix(".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.unlink(missing_ok=True)
        with os.fdopen(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
            json.dump(kept, file)
        part.replace(path)
    except OSError as error:
        raise SettingsError(f"cannot keep the tokens in {path}: {error.strerror}; choose another access.file") from None
    return tokens, shown


def _read(path: Path) -> Tokens:
    again = "; make new ones with 'teleop serve --new-tokens'"
    try:
        if path.stat().st_mode & 0o077:
            raise SettingsError(f"{path} can be read by others; run 'chmod 600 {path}', or better{again[1:]}")
        tree = json.loads(path.read_text(encoding="utf-8"))
        digests = {role: str(tree["digests"][role.label]) for role in Role}
        return Tokens(digests, bytes.fromhex(tree["signing_key"]))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise SettingsError(f"the tokens in {path} cannot be read: {error}{again}") from None


def _digest(token: str) -> str:
    return hashlib.sha256(token.encode()).hexdigest()
