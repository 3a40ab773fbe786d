"""The operator lease: one commands, others see and may ask for it. Pure: time and presence come in as arguments."""

from __future__ import annotations

from dataclasses import dataclass, replace

from server import wire
from server.access.roles import Caller, Role
from server.errors import Refused

LEASE_HELD = 423
"""HTTP "Locked": somebody else commands."""


@dataclass(frozen=True, slots=True)
class Change:
    """Something that happened to the lease. reason: ``lease.*``; detail: the names of those concerned."""

    reason: str
    detail: str


@dataclass(frozen=True, slots=True)
class Lease:
    """Holder and requests, oldest first. since: Unix time [s]."""

    holder: Caller | None = None
    since: float | None = None
    requests: tuple[Caller, ...] = ()

    def state(self) -> wire.LeaseState:
        """As the clients see it."""
        holder = self.holder.party if self.holder else None
        return wire.LeaseState(holder=holder, requests=tuple(c.party for c in self.requests), since=self.since)

    def held_by(self, caller: Caller) -> bool:
        """Whether it is this caller who may command."""
        return self.holder is not None and self.holder.id == caller.id

    def asks(self, caller: Caller) -> bool:
        """Whether the caller waits for the lease."""
        return any(c.id == caller.id for c in self.requests)


Step = tuple[Lease, tuple[Change, ...]]


def given_to(lease: Lease, caller: Caller, reason: str, t: float) -> Step:
    """The lease in new hands."""
    kept = tuple(c for c in lease.requests if c.id != caller.id)
    return Lease(caller, t, kept), (Change(reason, caller.party.name),)


def commanded(lease: Lease, caller: Caller, t: float) -> Step:
    """A command: takes a free lease. Raises Refused (423) while somebody else holds it.

    A caller of this machine that names no client acts for whichever client of this machine holds the lease.
    """
    if lease.holder is None:
        return given_to(lease, caller, "lease.granted", t) if caller.key else (lease, ())
    if lease.held_by(caller):
        return lease, ()
    if not caller.key and caller.local and lease.holder.local:
        return lease, ()
    name = lease.holder.party.name
    raise Refused(LEASE_HELD, f"{name} is in control; ask with POST /api/v1/lease/request", "lease")


def requested(lease: Lease, caller: Caller, t: float) -> Step:
    """Ask for the lease: a free one is granted, a held one is asked for. Asking twice does no harm.

    Raises Refused (422) without a client key.
    """
    _must_be_known(caller)
    if lease.held_by(caller) or lease.asks(caller):
        return lease, ()
    if lease.holder is None:
        return given_to(lease, caller, "lease.granted", t)
    return replace(lease, requests=(*lease.requests, caller)), (Change("lease.requested", caller.party.name),)


def released(lease: Lease, caller: Caller, t: float) -> Step:
    """Give the lease up, or withdraw a request. The oldest request is granted."""
    if lease.held_by(caller):
        return _freed(lease, "lease.released", t)
    return replace(lease, requests=tuple(c for c in lease.requests if c.id != caller.id)), ()


def granted(lease: Lease, caller: Caller, to: str, t: float) -> Step:
    """The holder, or a supervisor, hands over to one who asks. Raises Refused (404, 423)."""
    _must_decide(lease, caller)
    return given_to(lease, _asking(lease, to), "lease.granted", t)


def denied(lease: Lease, caller: Caller, to: str) -> Step:
    """The holder, or a supervisor, says no to one who asks. Raises Refused (404, 423)."""
    _must_decide(lease, caller)
    asking = _asking(lease, to)
    kept = tuple(c for c in lease.requests if c.id != asking.id)
    return replace(lease, requests=kept), (Change("lease.denied", asking.party.name),)


def taken(lease: Lease, caller: Caller, t: float) -> Step:
    """A supervisor takes the lease whoever holds it. Raises Refused (422) without a client key."""
    if lease.held_by(caller):
        return lease, ()
    if lease.holder is None:
        return requested(lease, caller, t)
    _must_be_known(caller)
    lease, _ = given_to(lease, caller, "lease.taken", t)
    return lease, (Change("lease.taken", caller.party.name),)


def watched(lease: Lease, present: frozenset[str], t: float) -> Step:
    """Drop who is gone; the lease lapses with its holder. present: ids of the clients that are still there."""
    kept = tuple(c for c in lease.requests if c.id in present)
    lease = lease if len(kept) == len(lease.requests) else replace(lease, requests=kept)
    if lease.holder is None or lease.holder.id in present:
        return lease, ()
    return _freed(lease, "lease.lapsed", t)


def _freed(lease: Lease, reason: str, t: float) -> Step:
    assert lease.holder is not None
    over = Change(reason, lease.holder.party.name)
    free = Lease(requests=lease.requests)
    if not free.requests:
        return free, (over,)
    free, changes = given_to(free, free.requests[0], "lease.granted", t)
    return free, (over, *changes)


def _must_be_known(caller: Caller) -> None:
    if not caller.key:
        raise Refused(
            422, "the lease is one client's; name yours with the header X-Teleop-Client (16 letters or digits)"
        )


def _must_decide(lease: Lease, caller: Caller) -> None:
    if not lease.held_by(caller) and caller.role is not Role.SUPERVISOR:
        who = lease.holder.party.name if lease.holder else "nobody"
        raise Refused(LEASE_HELD, f"only who holds the lease ({who}) or a supervisor decides about it", "lease")


def _asking(lease: Lease, to: str) -> Caller:
    for caller in lease.requests:
        if caller.id == to:
            return caller
    asking = ", ".join(f"{c.id} ({c.party.name})" for c in lease.requests) or "nobody"
    raise Refused(404, f"'{to[:20]}' does not ask for the lease; asking: {asking}")
