"""The three roles and the caller of a request."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from enum import IntEnum

from server import wire


class Role(IntEnum):
    """Each may do what the one before it may. viewer: sees everything and may stop the robot. operator: commands,
    with the lease. supervisor: takes the lease over."""

    VIEWER = 1
    OPERATOR = 2
    SUPERVISOR = 3

    @property
    def label(self) -> wire.RoleName:
        """As the wire names it."""
        labels: dict[Role, wire.RoleName] = {
            Role.VIEWER: "viewer",
            Role.OPERATOR: "operator",
            Role.SUPERVISOR: "supervisor",
        }
        return labels[self]


@dataclass(frozen=True, slots=True)
class Caller:
    """Who sends a request.

    key: the client's own secret, by which it is known again; empty when it names none. local: from this machine,
    by its own name. address: of the peer, for logs and rates. by_token: the role was shown by a token or a login.
    """

    role: Role
    key: str
    name: str
    local: bool
    address: str
    by_token: bool = False

    @property
    def id(self) -> str:
        """What others may know of the key: a short digest. Callers without a key are known by their address."""
        return hashlib.sha256((self.key or f"address {self.address}").encode()).hexdigest()[:10]

    @property
    def party(self) -> wire.Party:
        """As everybody sees it."""
        return wire.Party(id=self.id, name=self.name or f"{self.role.label} {self.id[:4]}", role=self.role.label)

    def __str__(self) -> str:
        return f"{self.party.name} ({self.role.label} {self.id}, {self.address})"
