"""Frames pushed over the websocket become the source."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from dataclasses import replace

import httpx
import pytest
from live_server import frames, running
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from teleop.sources.push_codec import decode_ack, encode_camera, encode_frame


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with running(tmp_path_factory.mktemp("push")) as (url, _):
        yield url


def push_url(url: str) -> str:
    return f"{url.replace('http', 'ws')}/api/v1/push"


def source(url: str) -> dict[str, object] | None:
    state = httpx.get(f"{url}/api/v1/state").raise_for_status().json()
    return None if state["source"] is None else dict(state["source"])


def test_pushed_frames_are_tracked_while_the_sender_is_there(url: str) -> None:
    with connect(push_url(url)) as sender:
        sender.send(encode_camera(frames()[0].camera, has_color=True))
        seen = False
        for i in range(120):
            frame = replace(frames()[i % 60], t_ns=i * 50_000_000, seq=i)
            sender.send(encode_frame(frame))
            assert decode_ack(str(sender.recv(timeout=20))) == i
            if seen := httpx.get(f"{url}/api/v1/state").json()["skeleton"] is not None:
                break
        assert seen
        playing = source(url)
        assert playing is not None and playing["live"] and playing["kind"] == "push"
        with connect(push_url(url)) as second:
            second.send(encode_camera(frames()[0].camera, has_color=False))
            assert "is running" in json.loads(second.recv(timeout=20))["detail"]
    end_s = time.monotonic() + 20
    while source(url) is not None and time.monotonic() < end_s:
        time.sleep(0.05)
    assert source(url) is None


@pytest.mark.parametrize("opening", ["rubbish", "{}", '{"type":"camera","version":1,"camera":{}}'])
def test_a_wrong_opening_is_one_clear_error(url: str, opening: str) -> None:
    with connect(push_url(url)) as sender:
        sender.send(opening)
        assert json.loads(sender.recv(timeout=20))["detail"].startswith("push:")
        with pytest.raises(ConnectionClosed):
            sender.recv(timeout=20)


def test_a_wrong_frame_ends_the_session(url: str) -> None:
    with connect(push_url(url)) as sender:
        sender.send(encode_camera(frames()[0].camera, has_color=True))
        sender.send(b"not a frame")
        assert "push:" in json.loads(sender.recv(timeout=20))["detail"]


def test_a_session_cannot_be_asked_to_wait_for_frames(url: str) -> None:
    response = httpx.post(f"{url}/api/v1/sessions", json={"source": "push:"})
    assert response.status_code == 422 and "/api/v1/push" in response.json()["detail"]
