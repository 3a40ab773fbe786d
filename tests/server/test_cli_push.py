"""``teleop push`` against the real server's /push."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import httpx
import pytest
from live_server import COUNT, TOKEN, running, write_walk
from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve

from server.access.roles import Role
from server.cli.push_run import PushOptions, paced, push_frames
from server.engine.engine import Engine
from teleop.errors import SourceError
from teleop.frames import DepthFrame
from teleop.recording import McapSource
from teleop.sources.push_codec import decode_camera, decode_frame, encode_ack


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Engine]]:
    with running(tmp_path_factory.mktemp("push-client")) as (url, engine):
        yield url, engine


@pytest.fixture
def walk(tmp_path: Path) -> Iterator[McapSource]:
    source = McapSource(write_walk(tmp_path / "walk.mcap", 30))
    yield source
    source.close()


def push_url(url: str) -> str:
    return f"{url.replace('http', 'ws')}/api/v1/push"


def test_frames_arrive_and_are_tracked(server: tuple[str, Engine], walk: McapSource) -> None:
    url, engine = server
    before = engine.frames
    seen: list[str] = []

    def look(_frame: DepthFrame) -> None:
        state = httpx.get(f"{url}/api/v1/state").json()
        if state["source"] is not None:
            seen.append(state["source"]["kind"])

    sent = push_frames(walk, push_url(url), PushOptions(window=30), look)
    assert sent.sent == 30 and sent.dropped == 0 and sent.connections == 1
    assert "push" in seen
    # the engine takes the newest frame; on a slow machine some give way before it
    assert 1 <= engine.frames - before <= 30


def test_a_server_that_is_busy_refuses_in_one_line(server: tuple[str, Engine], walk: McapSource) -> None:
    url, engine = server
    while engine.session is not None:
        engine.close_session(engine.session.id)
    httpx.post(f"{url}/api/v1/sessions", json={"source": "walk", "loop": True}).raise_for_status()
    with pytest.raises(SourceError, match="the server refuses: 'walk' is running"):
        push_frames(walk, push_url(url), PushOptions())


@pytest.mark.parametrize("address", ["http://127.0.0.1:1/api/v1/push", "nonsense"])
def test_a_wrong_address_is_one_error(walk: McapSource, address: str) -> None:
    with pytest.raises(SourceError, match="is no websocket address"):
        push_frames(walk, address, PushOptions())


@pytest.mark.parametrize(
    ("token", "why"), [(TOKEN[Role.VIEWER], "does not take this token"), ("guess", "does not take this")]
)
def test_a_token_that_may_not_push_is_one_error(
    server: tuple[str, Engine], walk: McapSource, token: str, why: str
) -> None:
    with pytest.raises(SourceError, match=why):
        push_frames(walk, push_url(server[0]), PushOptions(token=token))


def test_an_operators_token_opens_the_line(server: tuple[str, Engine], walk: McapSource) -> None:
    url, engine = server
    while engine.session is not None:
        engine.close_session(engine.session.id)
    assert push_frames(walk, push_url(url), PushOptions(window=30, token=TOKEN[Role.OPERATOR])).sent == 30


def test_a_certificate_that_is_none_is_one_error(walk: McapSource, tmp_path: Path) -> None:
    (tmp_path / "ca.pem").write_text("nothing")
    with pytest.raises(SourceError, match="--ca takes a PEM file"):
        push_frames(walk, "wss://127.0.0.1:1/api/v1/push", PushOptions(ca=tmp_path / "ca.pem"))


def test_nobody_there_is_told_at_once(walk: McapSource) -> None:
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        port = unused.getsockname()[1]
    with pytest.raises(SourceError, match=r"no connection to .*teleop serve"):
        push_frames(walk, f"ws://127.0.0.1:{port}/", PushOptions())


def test_a_lost_connection_is_made_again_and_silence_fills_the_window(walk: McapSource) -> None:
    """A receiver that hangs up after five frames, refuses once, then takes the rest but answers nothing."""
    visits: list[list[int]] = []

    def receive(line: ServerConnection) -> None:
        camera, _ = decode_camera(str(line.recv()))
        got: list[int] = []
        visits.append(got)
        if len(visits) == 2:
            line.send('{"type": "error", "detail": "busy"}')
            return
        try:
            while len(visits) > 1 or len(got) < 5:
                frame = decode_frame(bytes(line.recv()), camera)  # type: ignore[arg-type]
                got.append(frame.seq)
                if len(visits) == 1:
                    line.send(encode_ack(frame.seq))
        except ConnectionClosed:
            return

    with serve(receive, "127.0.0.1", 0) as listening:
        thread = threading.Thread(target=listening.serve_forever, daemon=True)
        thread.start()
        port = listening.socket.getsockname()[1]
        sent = push_frames(walk, f"ws://127.0.0.1:{port}/", PushOptions(window=4, lost_s=60.0))
        listening.shutdown()
        thread.join(10)
    first, _, last = visits
    assert first == [0, 1, 2, 3, 4] and len(last) == 4, "no more than the window without an answer"
    assert sent.connections == 3 and sent.dropped > 10
    assert last == sorted(last) and last[0] >= 5


def test_the_recordings_own_times_are_kept_and_a_loop_goes_on(walk: McapSource) -> None:
    frames = paced(walk, PushOptions(loop=True, seconds=1.6))
    stamps = [(frame.t_ns, frame.seq) for frame in frames]
    assert [seq for _, seq in stamps] == list(range(len(stamps))) and len(stamps) > 30
    assert all(a < b for (a, _), (b, _) in pairwise(stamps))
    assert stamps[1][0] - stamps[0][0] == 50_000_000 and COUNT > 30
