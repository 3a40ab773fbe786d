"""The websocket: hello first, latest wins, nobody is slowed by a client that does not read."""

from __future__ import annotations

import json
import socket
import time
from collections.abc import Iterator

import httpx
import pytest
from live_server import running
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from server import wire
from server.engine.engine import Engine
from server.images_wire import ImageKind, ImagePacket


@pytest.fixture(scope="module")
def live(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Engine]]:
    with running(tmp_path_factory.mktemp("stream"), stream={"max_events": 100, "max_clients": 3}) as (url, engine):
        httpx.post(f"{url}/api/v1/sessions", json={"source": "walk", "loop": True}).raise_for_status()
        yield url, engine


def opened(url: str, **options: object) -> ClientConnection:
    return connect(f"{url.replace('http', 'ws')}/api/v1/stream", max_size=None, **options)  # type: ignore[arg-type]


def next_of(client: ClientConnection, kind: str, timeout_s: float = 20.0) -> dict[str, object]:
    end_s = time.monotonic() + timeout_s
    while time.monotonic() < end_s:
        message = client.recv(timeout=timeout_s)
        if isinstance(message, str) and (body := json.loads(message))["type"] == kind:
            return dict(body)
    raise AssertionError(f"no {kind} came")


def test_hello_comes_first_and_states_are_what_the_wire_says(live: tuple[str, Engine]) -> None:
    with opened(live[0]) as client:
        first = wire.Hello.model_validate_json(client.recv(timeout=20))
        assert first.zones.depth_cuts_m == (1.4, 1.9, 2.8, 3.4)
        assert (first.zones.center_half_width_m, first.zones.side_limit_m) == (0.4, 0.9)
        assert first.camera.width == 320 and len(first.scenery) > 50
        seen = [wire.State.model_validate(next_of(client, "state")) for _ in range(5)]
        assert [s.seq for s in seen] == sorted({s.seq for s in seen})


def test_pictures_come_as_asked(live: tuple[str, Engine]) -> None:
    def picture(client: ClientConnection, kind: ImageKind) -> ImagePacket:
        for _ in range(500):
            message = client.recv(timeout=20)
            if isinstance(message, bytes) and (packet := ImagePacket.from_bytes(message)).kind is kind:
                return packet
        raise AssertionError(f"no {kind.name} came")

    with opened(live[0]) as client:
        depth = picture(client, ImageKind.DEPTH)
        assert (depth.width, depth.height) == (320, 240) and depth.jpeg[:2] == b"\xff\xd8"
        client.send('{"type":"view","image":"color","head":true}')
        assert picture(client, ImageKind.COLOR).width == 320
        assert picture(client, ImageKind.HEAD).width == 240
        assert ImageKind.PARTS not in live[1]._hub.wanted, "nobody has asked for the body parts"
        client.send('{"type":"view","image":"none","parts":true}')
        parts = picture(client, ImageKind.PARTS)
        assert parts.jpeg[:4] == b"\x89PNG" and 40 <= parts.width <= 320


def test_a_painted_state_gives_the_latency_of_the_whole_way(live: tuple[str, Engine]) -> None:
    with opened(live[0]) as client:
        for _ in range(200):
            state = next_of(client, "state")
            client.send(json.dumps({"type": "painted", "seq": state["seq"], "paint_ms": 0.25}))
            latency = state["latency_ms"]
            assert isinstance(latency, dict)
            if "total" in latency and "filter" in latency:
                assert latency["total"]["last"] >= latency["tracking"]["p50"] * 0.1 > 0
                assert latency["motion"]["p50"] > latency["total"]["p50"], "the filter's delay is part of it"
                assert latency["paint"]["p50"] == 0.25 and latency["send"]["p50"] >= 0.0
                return
        raise AssertionError("no total latency")


@pytest.mark.parametrize("text", ["rubbish", "{}", '{"type":"painted","seq":-1}', '{"type":"view","image":"x"}', "[]"])
def test_a_wrong_message_gets_an_error_and_the_stream_goes_on(live: tuple[str, Engine], text: str) -> None:
    with opened(live[0]) as client:
        client.send(text)
        assert "legal types: painted, view" in str(next_of(client, "error")["detail"])
        next_of(client, "state")


def test_events_reach_everybody(live: tuple[str, Engine]) -> None:
    with opened(live[0]) as one, opened(live[0]) as two:
        for client in (one, two):
            next_of(client, "state")
        httpx.post(f"{live[0]}/api/v1/estop").raise_for_status()
        for client in (one, two):
            while next_of(client, "event")["reason"] != "stop.estop":
                continue
        httpx.post(f"{live[0]}/api/v1/estop/reset").raise_for_status()


def test_a_new_client_hears_what_happened_before_it_came(live: tuple[str, Engine]) -> None:
    url, engine = live
    for i in range(60):
        engine.publisher.announce("test", "test.past", str(i))
    with opened(url) as client:
        next_of(client, "hello")
        past = [wire.EventMessage.model_validate(next_of(client, "event")) for _ in range(50)]
        told = [int(event.detail) for event in past if event.reason == "test.past"]
        assert told == list(range(60))[-len(told) :] and len(told) > 20, "the newest, in their order"
        assert all(event.position_s is not None for event in past if event.reason == "test.past")


def test_a_new_source_says_hello_again(live: tuple[str, Engine]) -> None:
    with opened(live[0]) as client:
        next_of(client, "hello")
        httpx.post(f"{live[0]}/api/v1/sessions", json={"source": "walk", "loop": True}).raise_for_status()
        next_of(client, "hello")


def test_one_too_many_and_foreign_pages_are_turned_away(live: tuple[str, Engine]) -> None:
    with opened(live[0]) as one, opened(live[0]) as two, opened(live[0]) as three:
        for client in (one, two, three):
            next_of(client, "state")
        with opened(live[0]) as fourth, pytest.raises(ConnectionClosed, match="3 clients"):
            fourth.recv(timeout=20)
    with pytest.raises(InvalidStatus, match="403"):
        opened(live[0], origin="http://evil.example")


def test_a_client_that_reads_nothing_slows_nobody_and_is_closed_at_last(live: tuple[str, Engine]) -> None:
    url, engine = live
    host, port = url.removeprefix("http://").split(":")
    stalled = socket.socket()
    stalled.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    stalled.connect((host, int(port)))
    stalled.sendall(
        f"GET /api/v1/stream HTTP/1.1\r\nHost: {host}:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
    )
    with stalled, opened(url) as reader:
        before = int(str(next_of(reader, "state")["seq"]))
        received = 0
        while True:
            state = next_of(reader, "state")
            received += 1
            assert state["clients"] in (1, 2)
            if int(str(state["seq"])) >= before + 60:
                break
        assert received >= 45, "the reader kept up"
        for _ in range(300):
            for _ in range(20):
                engine.publisher.announce("test", "test.flood")
            if next_of(reader, "state")["clients"] == 1:
                return
        raise AssertionError("the stalled client was never closed")
