"""Latest wins for frames and states; events are never lost."""

import asyncio
import threading

from live_server import frames

from server.access.roles import Caller, Role
from server.engine.ledger import Ledger
from server.engine.mailbox import Arrived, Mailbox
from server.stream.hub import Hub
from server.stream.outbox import Outbox


def test_the_newest_frame_wins_and_a_restart_is_not_forgotten() -> None:
    mailbox = Mailbox()
    mailbox.put(Arrived(frames()[0], 1.0, 0.0, restarted=True))
    mailbox.put(Arrived(frames()[1], 2.0, 0.03))
    taken = mailbox.take(0.0)
    assert taken is not None and taken.frame.seq == 1 and taken.restarted
    assert mailbox.dropped == 1
    assert mailbox.take(0.0) is None


def test_a_recorded_frame_waits_until_the_one_before_it_is_taken() -> None:
    mailbox = Mailbox()
    mailbox.hand_over(Arrived(frames()[0], 1.0, 0.0), lambda: False)
    late = threading.Thread(target=mailbox.hand_over, args=(Arrived(frames()[1], 1.0, 0.03), lambda: False))
    late.start()
    taken = []
    while len(taken) < 2:
        arrived = mailbox.take(5.0)
        assert arrived is not None
        taken.append(arrived.frame.seq)
    late.join(5)
    assert taken == [0, 1] and mailbox.dropped == 0


def test_a_reader_that_is_stopped_does_not_wait_for_the_engine() -> None:
    mailbox, stopped = Mailbox(), threading.Event()
    mailbox.hand_over(Arrived(frames()[0], 1.0, 0.0), stopped.is_set)
    waiting = threading.Thread(
        target=mailbox.hand_over, args=(Arrived(frames()[1], 1.0, 0.03), stopped.is_set), daemon=True
    )
    waiting.start()
    stopped.set()
    mailbox.wake()
    waiting.join(5)
    assert not waiting.is_alive()


def test_a_request_wakes_the_engine() -> None:
    mailbox = Mailbox()
    mailbox.wake()
    assert mailbox.take(60.0) is None


def test_a_client_gets_all_events_in_order_then_the_newest_of_each_kind() -> None:
    async def scenario() -> None:
        outbox = Outbox(max_events=10)
        for i in range(50):
            outbox.put("state", f"state {i}")
            outbox.put("DEPTH", bytes([i]))
        for i in range(3):
            outbox.put_event(f"event {i}")
        got = [await outbox.get() for _ in range(5)]
        assert got == ["event 0", "event 1", "event 2", "state 49", b"\x31"]
        assert outbox.replaced == 98

    asyncio.run(scenario())


def test_a_client_that_reads_no_events_is_to_be_closed() -> None:
    async def scenario() -> None:
        outbox = Outbox(max_events=2)
        for i in range(3):
            outbox.put_event(f"event {i}")
        assert outbox.overflowed.is_set()
        assert [await outbox.get() for _ in range(2)] == ["event 0", "event 1"]

    asyncio.run(scenario())


def test_wet_leaves_are_told_to_those_who_are_there_and_who_come_later() -> None:
    async def scenario() -> None:
        hub = Hub(max_clients=3, max_events=20, history=5)
        hub.bind(asyncio.get_running_loop())
        caller = Caller(Role.VIEWER, "a key of sixteen", "", True, "127.0.0.1")
        early = hub.join(caller)
        hub.post_kept("coverage", "wet")
        assert await early.outbox.get() == "wet"
        assert await hub.join(caller).outbox.get() == "wet"

    asyncio.run(scenario())


def test_latency_percentiles_look_back_on_the_window_only() -> None:
    ledger = Ledger(window=100)
    for ms in [9999.0, *range(1, 101)]:
        ledger.add("tracking", ms / 1e3)
    row = ledger.table()["tracking"]
    assert (row.p50, row.p95, row.last) == (51.0, 96.0, 100.0)
    ledger.clear()
    assert ledger.table() == {}
