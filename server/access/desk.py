"""The desk: who callers are, the lease as it stands, and what is told to everybody when it changes.

Belongs to the event loop's thread.
"""

from __future__ import annotations

import logging
import re
import time
from collections import Counter
from collections.abc import Callable
from http.cookies import CookieError, SimpleCookie
from ipaddress import ip_address
from urllib.parse import parse_qs, unquote, urlsplit

from starlette.datastructures import Headers
from starlette.types import Scope

from server import wire
from server.access import lease as leases
from server.access.lease import Change, Lease
from server.access.policy import Need
from server.access.rates import Rates
from server.access.roles import Caller, Role
from server.access.tokens import Tokens
from server.errors import Refused
from server.settings import LOOPBACK, AccessConfig

CLIENT_HEADER, NAME_HEADER = "x-teleop-client", "x-teleop-name"
_KEY = re.compile(r"[A-Za-z0-9_-]{16,80}")
_NAME_LENGTH = 40
_FORWARDED = ("forwarded", "x-forwarded-for", "x-real-ip", "via")
_AUDIT = logging.getLogger("teleop.audit")


Announce = Callable[[str, str, str], None]
"""kind, reason, detail: an event for every client."""
Audit = Callable[[str, str], None]
"""action, detail: a line for the recording."""


class Desk:
    """One for an application. changed: called after each change of the lease. taken: called after a take-over.
    lost: called when a holder has it no longer, however that came about."""

    def __init__(self, tokens: Tokens, config: AccessConfig, port: int, announce: Announce, audit: Audit) -> None:
        self.cookie_name = f"teleop_{port}"  # cookies know no port: two servers on one machine must not share one
        self.config = config
        self.tokens = tokens
        self.changed: Callable[[], None] = lambda: None
        self.taken: Callable[[], None] = lambda: None
        self.lost: Callable[[], None] = lambda: None
        self.refused: Counter[int] = Counter()
        self._announce = announce
        self._record = audit
        self._lease = Lease()
        self._streams: Counter[str] = Counter()
        self._seen: dict[str, float] = {}
        self._commands = Rates(config.commands_per_s, config.command_burst)
        self._failures = Rates(config.failed_logins_per_min / 60.0, config.failed_logins_per_min)
        self._audits: dict[tuple[str, str], tuple[float, int]] = {}

    # who

    def caller(self, scope: Scope) -> Caller | None:
        """Who sends this, None without any access.

        Raises Refused: 401 for a wrong token (a cookie that is no longer good is as good as none), 422 for a bad
        client key, 429 after too many wrong tokens.
        """
        headers = Headers(scope=scope)
        address = scope["client"][0] if scope.get("client") else ""
        shown = self._role(headers, address)
        role = shown or (self._local_role() if _is_local(address, headers) else None)
        return None if role is None else self.as_role(scope, role, by_token=shown is not None)

    def as_role(self, scope: Scope, role: Role, *, by_token: bool = True) -> Caller:
        """The sender in a role that it has shown to have, or has by itself. Raises Refused (422) for a bad key."""
        headers = Headers(scope=scope)
        address = scope["client"][0] if scope.get("client") else ""
        query = parse_qs(scope["query_string"].decode("latin-1")) if scope["type"] == "websocket" else {}
        key = headers.get(CLIENT_HEADER) or next(iter(query.get("client", ())), "")
        if key and not _KEY.fullmatch(key):
            raise Refused(422, "a client key has 16 to 80 letters, digits, dashes or underscores")
        name = unquote(headers.get(NAME_HEADER, "")) or next(iter(query.get("name", ())), "")
        caller = Caller(role, key, _printable(name), _is_local(address, headers), address, by_token)
        if key:
            self._seen[caller.id] = time.monotonic()
        return caller

    def login(self, token: str, address: str) -> Role:
        """The role of a token. Raises Refused: 401 for a wrong one, 429 after too many.

        A right one always passes: nobody can lock others of the same address out, and none can be guessed.
        """
        role = self.tokens.role_of(token)
        if role is not None:
            return role
        if wait_s := self._failures.wait_s(address, time.monotonic()):
            raise TooOften(wait_s, "too many wrong tokens from your address")
        _AUDIT.warning("wrong token", extra={"address": address})
        raise Refused(401, "that token is not known here; 'teleop serve --new-tokens' makes new ones", "token")

    def _role(self, headers: Headers, address: str) -> Role | None:
        scheme, _, token = headers.get("authorization", "").partition(" ")
        if scheme.lower() == "bearer":
            return self.login(token.strip(), address)
        try:
            cookie = SimpleCookie(headers.get("cookie", "")).get(self.cookie_name)
        except CookieError:
            return None
        return self.tokens.role_of_cookie(cookie.value, time.time()) if cookie else None

    def _local_role(self) -> Role | None:
        return None if self.config.local_role == "none" else Role[self.config.local_role.upper()]

    # may they

    def admit(self, caller: Caller | None, needs: Need, what: str) -> None:
        """Let a request pass, or raise Refused: 401, 403, 423, 429. what: method and path, for the audit."""
        if needs.role is None:
            return
        if caller is None:
            raise Refused(401, "a token is needed; send it as 'Authorization: Bearer TOKEN', or log in", "token")
        if caller.role < needs.role:
            raise Refused(403, f"this needs the role {needs.role.label}; yours is {caller.role.label}", "role")
        now_s = time.monotonic()
        if needs.limited and (wait_s := self._commands.wait_s(caller.address, now_s)):
            raise TooOften(wait_s, f"more than {self.config.commands_per_s:g} commands a second")
        if needs.lease:
            self._step(leases.commanded(self._lease, caller, time.time()))
        if needs.audited:
            self._audit(caller, what, now_s)

    def _audit(self, caller: Caller, what: str, now_s: float) -> None:
        """Log and record; of the same again and again only one a second, with the count."""
        last_s, count = self._audits.get((caller.id, what), (-1.0, 0))
        if now_s - last_s < 1.0:
            self._audits[(caller.id, what)] = (last_s, count + 1)
            return
        if len(self._audits) > 1000:
            self._audits.clear()
        self._audits[(caller.id, what)] = (now_s, 0)
        times = f", {count} more before" if count else ""
        self.note(what, f"{caller}{times}")

    def note(self, action: str, detail: str) -> None:
        """A line for the log and the recording."""
        _AUDIT.info("%s: %s", action, detail, extra={"action": action})
        self._record(action, detail)

    # the lease

    @property
    def lease(self) -> Lease:
        """As it stands."""
        return self._lease

    def access(self, caller: Caller | None) -> wire.Access:
        """What one client is told."""
        return wire.Access(
            you=caller.party if caller else None,
            by_token=caller is not None and caller.by_token,
            holds_lease=caller is not None and self._lease.held_by(caller),
            lease=self._lease.state() if caller else wire.LeaseState(),
        )

    def request(self, caller: Caller) -> None:
        """Ask for the lease. Raises Refused."""
        self._step(leases.requested(self._lease, caller, time.time()))

    def release(self, caller: Caller) -> None:
        """Give it up, or withdraw the request."""
        self._step(leases.released(self._lease, caller, time.time()))

    def grant(self, caller: Caller, to: str) -> None:
        """Hand over. Raises Refused."""
        self._step(leases.granted(self._lease, caller, to, time.time()))

    def deny(self, caller: Caller, to: str) -> None:
        """Say no. Raises Refused."""
        self._step(leases.denied(self._lease, caller, to))

    def take(self, caller: Caller) -> None:
        """A supervisor takes over; the robot disengages. Raises Refused."""
        before = self._lease.holder
        self._step(leases.taken(self._lease, caller, time.time()))
        if before is not None and not self._lease.held_by(before):
            self.taken()

    def joined(self, caller: Caller) -> None:
        """A stream of this client was opened."""
        self._streams[caller.id] += 1

    def left(self, caller: Caller) -> None:
        """It was closed."""
        self._seen[caller.id] = time.monotonic()
        self._streams[caller.id] -= 1
        if self._streams[caller.id] <= 0:
            del self._streams[caller.id]

    def watch(self) -> None:
        """Let a lease lapse whose holder is gone; to be called every second or so."""
        now_s = time.monotonic()
        gone = [key for key, seen_s in self._seen.items() if now_s - seen_s > self.config.lease_idle_s]
        for key in gone:
            del self._seen[key]
        self._step(leases.watched(self._lease, frozenset(self._streams) | frozenset(self._seen), time.time()))

    def _step(self, step: tuple[Lease, tuple[Change, ...]]) -> None:
        before, (self._lease, changes) = self._lease, step
        for change in changes:
            self._announce("lease", change.reason, change.detail)
            self.note(change.reason, change.detail)
        if changes or before.requests != self._lease.requests:
            self.changed()
        if before.holder is not None and not self._lease.held_by(before.holder):
            self.lost()


class TooOften(Refused):
    """429, with the time to wait [s]."""

    def __init__(self, wait_s: float, why: str) -> None:
        super().__init__(429, f"{why}; wait {wait_s:.1f} s", "rate")
        self.wait_s = wait_s


def _is_local(address: str, headers: Headers) -> bool:
    """A peer of this machine that calls the server by a name of this machine, with no proxy between.

    The name matters: a page of another site can have its name resolve to 127.0.0.1 (DNS rebinding).
    """
    try:
        loopback = ip_address(address).is_loopback
    except ValueError:
        return False
    host = (urlsplit(f"//{headers.get('host', '')}").hostname or "").lower()
    return loopback and host in LOOPBACK and not any(name in headers for name in _FORWARDED)


def _printable(name: str) -> str:
    return "".join(c for c in name if c.isprintable())[:_NAME_LENGTH].strip()
