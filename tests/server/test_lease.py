"""The lease as a value: who gets it, who waits, who loses it."""

from __future__ import annotations

import pytest

from server.access import lease as leases
from server.access.lease import Lease
from server.access.roles import Caller, Role
from server.errors import Refused

ANNA = Caller(Role.OPERATOR, "a" * 16, "Anna", True, "127.0.0.1")
BEN = Caller(Role.OPERATOR, "b" * 16, "Ben", False, "192.0.2.7")
EVE = Caller(Role.SUPERVISOR, "e" * 16, "Eve", False, "192.0.2.8")
SCRIPT = Caller(Role.OPERATOR, "", "", True, "127.0.0.1")


def of(lease: Lease) -> str:
    return lease.holder.name if lease.holder else ""


def test_the_first_command_takes_a_free_lease_and_nobody_else_commands() -> None:
    lease, changes = leases.commanded(Lease(), ANNA, 1.0)
    assert of(lease) == "Anna" and [c.reason for c in changes] == ["lease.granted"]
    assert leases.commanded(lease, ANNA, 2.0) == (lease, ())
    with pytest.raises(Refused, match="Anna is in control") as refused:
        leases.commanded(lease, BEN, 2.0)
    assert (refused.value.status, refused.value.code) == (423, "lease")


def test_a_local_script_without_a_name_acts_for_the_local_holder_and_takes_nothing() -> None:
    assert leases.commanded(Lease(), SCRIPT, 1.0) == (Lease(), ())
    held_here, _ = leases.commanded(Lease(), ANNA, 1.0)
    assert leases.commanded(held_here, SCRIPT, 2.0) == (held_here, ())
    held_elsewhere, _ = leases.commanded(Lease(), BEN, 1.0)
    with pytest.raises(Refused, match="Ben"):
        leases.commanded(held_elsewhere, SCRIPT, 2.0)


def test_who_asks_waits_until_the_holder_hands_over_or_lets_go() -> None:
    lease, _ = leases.requested(Lease(), ANNA, 1.0)
    lease, changes = leases.requested(lease, BEN, 2.0)
    assert of(lease) == "Anna" and [c.reason for c in changes] == ["lease.requested"]
    assert leases.requested(lease, BEN, 3.0) == (lease, ()), "asking twice does no harm"
    handed, _ = leases.granted(lease, ANNA, BEN.id, 4.0)
    assert of(handed) == "Ben" and handed.requests == () and handed.since == 4.0
    let_go, changes = leases.released(lease, ANNA, 4.0)
    assert of(let_go) == "Ben" and [c.reason for c in changes] == ["lease.released", "lease.granted"]


def test_a_request_is_denied_or_withdrawn() -> None:
    lease, _ = leases.requested(leases.requested(Lease(), ANNA, 1.0)[0], BEN, 2.0)
    denied, changes = leases.denied(lease, ANNA, BEN.id)
    assert denied.requests == () and [c.reason for c in changes] == ["lease.denied"]
    withdrawn, _ = leases.released(lease, BEN, 3.0)
    assert of(withdrawn) == "Anna" and withdrawn.requests == ()


def test_only_holder_and_supervisor_decide_and_only_about_who_asks() -> None:
    lease, _ = leases.requested(leases.requested(Lease(), ANNA, 1.0)[0], BEN, 2.0)
    with pytest.raises(Refused, match="only who holds the lease"):
        leases.granted(lease, BEN, BEN.id, 3.0)
    with pytest.raises(Refused, match=f"asking: {BEN.id} \\(Ben\\)"):
        leases.granted(lease, ANNA, "nobody", 3.0)
    assert of(leases.granted(lease, EVE, BEN.id, 3.0)[0]) == "Ben"


def test_a_supervisor_takes_over() -> None:
    lease, _ = leases.requested(Lease(), ANNA, 1.0)
    taken, changes = leases.taken(lease, EVE, 2.0)
    assert of(taken) == "Eve" and [(c.reason, c.detail) for c in changes] == [("lease.taken", "Eve")]
    assert leases.taken(taken, EVE, 3.0) == (taken, ())


def test_the_lease_lapses_with_its_holder_and_goes_to_who_waits() -> None:
    lease, _ = leases.requested(leases.requested(Lease(), ANNA, 1.0)[0], BEN, 2.0)
    assert leases.watched(lease, frozenset({ANNA.id, BEN.id}), 3.0) == (lease, ())
    waiting, changes = leases.watched(lease, frozenset({BEN.id}), 3.0)
    assert of(waiting) == "Ben" and [c.reason for c in changes] == ["lease.lapsed", "lease.granted"]
    nobody, changes = leases.watched(lease, frozenset(), 3.0)
    assert nobody == Lease() and [c.reason for c in changes] == ["lease.lapsed"]


def test_the_lease_needs_a_client_key_and_its_id_gives_no_key_away() -> None:
    for ask in (leases.requested, leases.taken):
        with pytest.raises(Refused, match="X-Teleop-Client"):
            ask(leases.commanded(Lease(), ANNA, 1.0)[0], SCRIPT, 2.0)
    assert ANNA.key not in ANNA.party.model_dump_json() and ANNA.id != BEN.id
