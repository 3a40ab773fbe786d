"""What each request needs: one table, read by the gate and by the OpenAPI document.

Whatever is not named here is safe by default: reading needs a viewer, changing an operator with the lease.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from server.access.roles import Role

API = "/api/v1"
SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})


@dataclass(frozen=True, slots=True)
class Need:
    """role: None = open to all. lease: only who commands. limited: counts against the rate of commands.
    audited: told in the log and in the recording."""

    role: Role | None
    lease: bool = False
    limited: bool = False
    audited: bool = False


OPEN = Need(None)
VIEW = Need(Role.VIEWER)
COMMAND = Need(Role.OPERATOR, lease=True, limited=True, audited=True)
MANAGE = Need(Role.OPERATOR, limited=True, audited=True)
"""Changes something, but not what the robot does."""
LEASE = Need(Role.OPERATOR, limited=True)
"""The lease tells of its changes itself."""

_TABLE: tuple[tuple[str, str, Need], ...] = (
    ("GET", r"/health|/ready|/access", OPEN),
    # a login names itself: it has its own rate, of failures
    ("POST", r"/login|/logout", OPEN),
    # never kept from stopping the robot: no lease, no rate
    ("POST", r"/estop", Need(Role.VIEWER, audited=True)),
    ("POST", r"/lease/take", Need(Role.SUPERVISOR, limited=True)),
    ("POST", r"/lease/\w+", LEASE),
    ("POST", r"/recordings(/.*)?", MANAGE),
    ("DELETE", r"/recordings/.*", MANAGE),
    ("DELETE", r"/jobs/.*", MANAGE),
    ("PUT", r"/operators/.*", MANAGE),
    ("DELETE", r"/operators/.*", MANAGE),
    ("WS", r"/stream", VIEW),
    ("WS", r"/push", Need(Role.OPERATOR, audited=True)),
)


def need(method: str, path: str) -> Need:
    """What a request needs. method: of HTTP, or ``WS`` for a websocket."""
    if path == "/metrics":
        return VIEW
    if path != API and not path.startswith(f"{API}/"):
        return OPEN if method in SAFE_METHODS else COMMAND  # the console's own files and the documentation
    inner = path.removeprefix(API)
    for verb, pattern, found in _TABLE:
        if (verb == method or (verb == "GET" and method == "HEAD")) and re.fullmatch(pattern, inner):
            return found
    return VIEW if method in SAFE_METHODS else COMMAND
