"""A live Kinect (libfreenect's fakenect, in its own process) is pulled under the running server, and comes back."""

from __future__ import annotations

import json
import os
import signal
import time
from itertools import pairwise
from pathlib import Path

import httpx
import numpy as np
import pytest
from live_server import running
from websockets.sync.client import connect

from server.engine.engine import Engine
from teleop.frames import DepthFrame
from teleop.recording import McapSource, topics
from teleop.recording.fakenect_writer import FakenectWriter
from teleop.sources.driver_process import DriverProcess
from teleop.sources.freenect import UNREGISTERED
from teleop.sources.reconnect import Reconnecting

FAKENECT = Path("/usr/lib/x86_64-linux-gnu/fakenect")
DEADLINE_S = 60.0

pytestmark = pytest.mark.skipif(
    not (FAKENECT / "libfreenect.so.0.5").exists(),
    reason="libfreenect's fakenect is not installed (apt install libfreenect0.5)",
)


@pytest.fixture
def dump(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "a.fakenect"
    writer = FakenectWriter(folder, UNREGISTERED)
    for i in range(20):
        depth = np.full((480, 640), 2500 + 10 * i, np.uint16)
        color = np.full((480, 640, 3), 10 * i, np.uint8)
        writer.write_frame(DepthFrame(i * 33_333_333, depth, UNREGISTERED, color, i))
    writer.close()
    monkeypatch.setenv("LD_LIBRARY_PATH", str(FAKENECT))
    monkeypatch.setenv("FAKENECT_PATH", str(folder))
    return folder


def driver(engine: Engine) -> DriverProcess:
    assert engine.session is not None
    lasting = engine.session.source
    assert isinstance(lasting, Reconnecting) and isinstance(lasting._source, DriverProcess)
    return lasting._source


def wait(what: object, api: httpx.Client) -> dict[str, object]:
    end_s = time.monotonic() + DEADLINE_S
    while True:
        state = api.get("/state").json()
        if what(state):  # type: ignore[operator]
            return dict(state)
        assert time.monotonic() < end_s, state["source"]
        time.sleep(0.02)


def test_the_robot_stops_and_the_camera_comes_back_by_itself(dump: Path, tmp_path: Path) -> None:
    with (
        running(tmp_path, sensor={"retry_s": 0.2}) as (url, engine),
        httpx.Client(base_url=f"{url}/api/v1", timeout=60.0) as api,
        connect(f"{url.replace('http', 'ws')}/api/v1/stream") as stream,
    ):
        asked = {"source": "freenect:0", "record": True}
        session = api.post("/sessions", json=asked).raise_for_status().json()
        wait(lambda s: s["source"] and engine.frames > 5, api)
        os.kill(driver(engine).process_id, signal.SIGKILL)
        lost = wait(lambda s: s["source"]["fault"], api)
        assert "crashed (SIGKILL)" in lost["source"]["fault"]  # type: ignore[index]
        wait(lambda s: "stop.source_failed" in s["command"]["reasons"], api)
        seen = engine.frames
        wait(lambda s: s["source"]["fault"] is None and engine.frames > seen + 5, api)
        api.delete(f"/sessions/{session['id']}").raise_for_status()
        reasons = []
        while "source.closed" not in reasons:
            message = stream.recv(timeout=DEADLINE_S)
            event = json.loads(message) if isinstance(message, str) else {}
            if event.get("type") == "event":
                reasons.append(event["reason"])
    order = [r for r in reasons if r.startswith("source.")]
    # fakenect ends its process with its dump, so the camera may be lost once more
    assert order[:3] == ["source.opened", "source.camera_lost", "source.camera_back"]
    assert order[-1] == "source.closed"
    source = McapSource(tmp_path / "own" / f"{session['recording']}.mcap")
    recorded = [row["reason"] for _, row in source.rows(topics.EVENTS) if row["kind"] == "source"]
    assert recorded[:2] == ["source.camera_lost", "source.camera_back"]
    assert any(row.get("source_failed") for _, row in source.rows(topics.INPUTS))
    assert source.info.frame_count is not None and source.info.frame_count > 10
    assert all(a.t_ns < b.t_ns for a, b in pairwise(source.frames()))
