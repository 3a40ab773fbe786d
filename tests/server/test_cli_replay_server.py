"""A session recorded by the running server, with everything a client may do to it, replays bit for bit."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import httpx
from live_server import COUNT, running

from server.cli.replay_run import compare
from server.cli.replay_words import lines
from teleop.body.model import load_model
from teleop.recording import McapSource, topics

DEADLINE_S = 60.0


def wait_for(api: httpx.Client, position_s: float) -> None:
    end_s = time.monotonic() + DEADLINE_S
    while (source := api.get("/state").json()["source"])["position_s"] < position_s and not source["ended"]:
        assert time.monotonic() < end_s
        time.sleep(0.02)


def done(api: httpx.Client, path: str, body: dict[str, Any] | None = None) -> None:
    api.post(path, json=body).raise_for_status()


def test_what_the_server_recorded_replays_bit_for_bit(tmp_path: Path) -> None:
    with running(tmp_path) as (url, _), httpx.Client(base_url=f"{url}/api/v1") as api:
        done(api, "/robot/command", {"lift_m": 0.3})  # the robot is not at its start when the session begins
        session = api.post("/sessions", json={"source": "walk", "loop": False, "record": True}).json()
        done(api, "/replay/speed", {"speed": 0.5})  # time enough for a slow machine
        wait_for(api, 0.4)
        done(api, "/engage")
        done(api, "/robot/command", {"lift_m": 0.25, "drive_m_s": 0.1, "for_s": 0.5})
        wait_for(api, 1.0)
        done(api, "/replay/pause")
        end_s = time.monotonic() + DEADLINE_S
        while "stop.no_frame" not in api.get("/state").json()["reasons"]:  # the watchdog holds, then stops
            assert time.monotonic() < end_s
            time.sleep(0.02)
        done(api, "/replay/play")
        wait_for(api, 1.4)
        done(api, "/estop")
        wait_for(api, 1.8)
        done(api, "/estop/reset")
        done(api, "/replay/speed", {"speed": 1.0})
        wait_for(api, 2.2)
        api.patch("/config", json={"teleop": {"intent": {"mapping": {"step_deg": 5.0}}}}).raise_for_status()
        wait_for(api, 2.9)
        api.delete(f"/sessions/{session['id']}").raise_for_status()
        path = tmp_path / "own" / f"{session['recording']}.mcap"
        source = McapSource(path)
        try:
            rows = [row for _, row in source.rows(topics.INPUTS)]
            found = compare(source, load_model())
        finally:
            source.close()
    assert found.identical, lines(found, [])
    assert found.between > 10, "the half second in which no frame came"
    assert 10 < found.frames <= COUNT
    asked = [row for row in rows if "settings" not in row]
    assert len(rows) - len(asked) == 1
    assert any(row["engage"] for row in asked) and any(row["latched"] for row in asked)
    assert any(row["request"] for row in asked) and any(row["watchdog"] for row in asked)
    assert {row["speed"] for row in asked} >= {1.0, 0.5} and not all(row["frame"] for row in asked)
