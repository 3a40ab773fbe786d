"""The HTTP API against the real engine and robot."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import httpx
import pytest
from live_server import running, write_walk

from server.engine.engine import Engine

PROBLEM = "application/problem+json"


@pytest.fixture(scope="module")
def live(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[httpx.Client, Engine]]:
    with (
        running(tmp_path_factory.mktemp("api"), upload={"recording_mb": 1, "json_kb": 4}) as (url, engine),
        httpx.Client(base_url=f"{url}/api/v1", timeout=20) as client,
    ):
        yield client, engine


@pytest.fixture
def api(live: tuple[httpx.Client, Engine]) -> Iterator[httpx.Client]:
    """With the walk playing in a loop, engaged by nobody, and no e-stop."""
    client, _ = live
    assert client.post("/sessions", json={"source": "walk", "loop": True}).status_code == 201
    client.post("/estop/reset")
    yield client


def until(ask: Callable[[], Any], timeout_s: float = 20.0) -> Any:
    end_s = time.monotonic() + timeout_s
    while time.monotonic() < end_s:
        if answer := ask():
            return answer
        time.sleep(0.02)
    raise AssertionError("it never came true")


def refused(response: httpx.Response, status: int, *words: str) -> None:
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == PROBLEM
    body = response.json()
    assert body["status"] == status
    for word in words:
        assert word in body["detail"], body["detail"]


def test_health_and_state_tell_of_the_source(api: httpx.Client) -> None:
    assert api.get("/health").json()["source"] == "walk"
    state = until(lambda: (s := api.get("/state").json())["skeleton"] and s)
    assert state["source"]["kind"] == "mcap"
    assert len(state["skeleton"]["joints"]) == 20
    assert {"capture", "tracking", "intent", "simulation"} <= set(state["latency_ms"])


def test_the_emergency_stop_stops_the_robot_and_is_released(api: httpx.Client) -> None:
    for _ in range(2):
        assert api.post("/estop").json() == {"accepted": True}
    assert api.get("/state").status_code == 200
    state = until(lambda: (s := api.get("/state").json())["robot"]["estop"] and s)
    assert state["command"]["drive_m_s"] == 0.0
    api.post("/robot/command", json={"lift_m": 0.35})
    until(lambda: "stop.estop" in api.get("/state").json()["reasons"])
    assert api.get("/state").json()["robot"]["targets"]["lift"] < 0.2
    api.post("/estop/reset")
    until(lambda: not api.get("/state").json()["robot"]["estop"])


def test_lift_and_disc_follow_the_console(api: httpx.Client) -> None:
    assert api.post("/robot/command", json={"lift_m": 0.2, "disc_rad": 0.3}).status_code == 200
    until(lambda: abs(api.get("/state").json()["robot"]["joints"]["lift"] - 0.2) < 0.01)
    until(lambda: abs(api.get("/state").json()["robot"]["joints"]["disc"] - 0.3) < 0.02)


def test_the_lift_moves_without_any_source(api: httpx.Client) -> None:
    running_now = next(s for s in api.get("/sessions").json() if s["running"])
    assert api.delete(f"/sessions/{running_now['id']}").status_code == 204
    assert api.delete(f"/sessions/{running_now['id']}").status_code == 204
    assert api.get("/state").json()["source"] is None
    refused(api.post("/engage"), 409, "no source")
    refused(api.post("/replay/pause"), 409, "nothing is playing")
    api.post("/robot/command", json={"lift_m": 0.05})
    until(lambda: abs(api.get("/state").json()["robot"]["joints"]["lift"] - 0.05) < 0.01)
    api.post("/robot/command", json={"drive_m_s": 0.2, "for_s": 0.5})
    until(lambda: api.get("/state").json()["robot"]["drive_m_s"] > 0.05)
    until(lambda: abs(api.get("/state").json()["robot"]["drive_m_s"]) < 0.01)


def test_engaging_takes_the_person_seen_and_pausing_stops_the_robot(api: httpx.Client) -> None:
    until(lambda: api.get("/state").json()["mode"] == "seen")
    api.post("/engage")
    until(lambda: api.get("/state").json()["engaged"])
    assert api.post("/replay/pause").json()["paused"]
    state = until(lambda: "stop.no_frame" in (s := api.get("/state").json())["reasons"] and s)
    assert state["command"]["drive_m_s"] == 0.0 and not state["command"]["spray_on"]
    api.post("/replay/play")
    until(lambda: "stop.no_frame" not in api.get("/state").json()["reasons"])
    api.post("/disengage")
    until(lambda: not api.get("/state").json()["engaged"])


def test_replay_controls(api: httpx.Client) -> None:
    assert api.post("/replay/speed", json={"speed": 0.5}).json()["speed"] == 0.5
    api.post("/replay/pause")
    assert api.post("/replay/seek", json={"position_s": 1.5}).json()["position_s"] == 1.5
    until(lambda: abs(api.get("/state").json()["source"]["position_s"] - 1.5) < 0.04)
    refused(api.post("/replay/seek", json={"position_s": 99}), 422, "legal: 0 <= position_s <= 2.95")
    refused(api.post("/replay/speed", json={"speed": 0}), 422, "speed")
    refused(api.post("/replay/seek", json={"position": 1}), 422, "position")
    assert api.post("/replay/loop", json={"loop": False}).json()["loop"] is False
    api.post("/replay/speed", json={"speed": 8})
    api.post("/replay/play")
    until(lambda: api.get("/state").json()["source"]["ended"])
    assert api.post("/replay/loop", json={"loop": True}).json()["loop"] is True
    refused(api.post("/replay/loop", json={"loop": "often"}), 422, "loop")


def test_configuration_is_changed_or_refused_as_a_whole(api: httpx.Client) -> None:
    patch = {"teleop": {"intent": {"mapping": {"mapping": "direction"}}}}
    assert api.patch("/config", json=patch).json()["teleop"]["intent"]["mapping"]["mapping"] == "direction"
    assert api.get("/config").json()["teleop"]["intent"]["mapping"]["mapping"] == "direction"
    refused(api.patch("/config", json={"teleop": {"intent": {"zones": {"l1_m": 50}}}}), 422, "0.4 <= value <= 5.0")
    refused(api.patch("/config", json={"nonsense": 1}), 422, "no such setting")
    refused(api.patch("/config", json={"port": 9999}), 409, "restart")
    schema = api.get("/config/schema").json()
    assert schema["properties"]["port"]["maximum"] == 65535


def test_recordings_come_and_go(api: httpx.Client, tmp_path: Path) -> None:
    path = write_walk(tmp_path / "mine.mcap", 10)
    created = api.post("/recordings", files={"file": ("mine.mcap", path.read_bytes())})
    assert created.status_code == 201, created.text
    assert created.json()["duration_s"] == pytest.approx(0.45, abs=0.01)
    assert [r["id"] for r in api.get("/recordings").json()][:2] == ["walk", "mine"]
    assert api.get("/recordings/mine").content == path.read_bytes()
    refused(api.post("/recordings", files={"file": ("mine.mcap", path.read_bytes())}), 409, "already")
    assert api.delete("/recordings/mine").status_code == 204
    refused(api.get("/recordings/mine"), 404, "there are: walk")
    refused(api.delete("/recordings/walk"), 409, "in use")


@pytest.mark.parametrize(
    "name", ["../evil.mcap", "..%2fevil.mcap", "/etc/passwd", ".hidden.mcap", "a b.mcap", "", "x" * 200, "a\x00b"]
)
def test_an_upload_cannot_leave_its_folder(api: httpx.Client, name: str) -> None:
    response = api.post("/recordings", files={"file": (name, b"data")})
    assert response.status_code == 422, response.text


@pytest.mark.parametrize("name", ["..", "%2e%2e", "..%2f..%2fetc%2fpasswd", "walk.mcap", "nothing"])
def test_no_name_reads_or_deletes_outside_the_library(api: httpx.Client, name: str) -> None:
    assert api.get(f"/recordings/{name}").status_code in (404, 405)
    assert api.delete(f"/recordings/{name}").status_code in (404, 405)


def test_uploads_that_are_wrong_or_too_large(api: httpx.Client) -> None:
    refused(api.post("/recordings", files={"file": ("junk.mcap", b"not an mcap")}), 422)
    refused(api.post("/recordings", files={"file": ("big.mcap", bytes(2_000_000))}), 413, "bytes")
    assert "junk" not in [r["id"] for r in api.get("/recordings").json()]
    refused(api.post("/robot/command", content=b" " * 5000, headers={"content-type": "application/json"}), 413)

    def endless() -> Iterator[bytes]:
        for _ in range(10):
            yield b" " * 1000

    streamed = api.post("/robot/command", content=endless(), headers={"content-type": "application/json"})
    refused(streamed, 413)


@pytest.mark.parametrize("source", ["nothing", "/etc/passwd", "../walk", "rubbish:", "freenect:../x"])
def test_a_session_opens_names_never_paths(api: httpx.Client, source: str) -> None:
    response = api.post("/sessions", json={"source": source})
    assert response.status_code in (403, 404, 422), response.text
    assert response.headers["content-type"] == PROBLEM
    assert api.get("/health").json()["source"] == "walk", "the session before goes on"


def test_a_session_is_recorded_and_ends_where_its_source_begins_again(api: httpx.Client) -> None:
    session = api.post("/sessions", json={"source": "walk", "loop": True, "record": True}).json()
    assert session["recording"].endswith("-walk")
    until(lambda: not api.get("/state").json()["source"]["recording"])
    entry = next(r for r in api.get("/recordings").json() if r["id"] == session["recording"])
    assert entry["duration_s"] == pytest.approx(2.95, abs=0.3)
    assert api.get(f"/sessions/{session['id']}").json()["running"]


@pytest.mark.parametrize(
    "body",
    [{"lift_m": "high"}, {"lift_m": 99}, {"drive_m_s": 50.0}, {"arms": 1}, {"right_arm": {"c1_deg": 1}}, [], "x", None],
)
def test_commands_that_make_no_sense_are_refused(api: httpx.Client, body: object) -> None:
    refused(api.post("/robot/command", json=body), 422)
    nan = api.post("/robot/command", content=b'{"lift_m": NaN}', headers={"content-type": "application/json"})
    refused(nan, 422)


def test_foreign_origins_and_hosts_may_not_command(api: httpx.Client) -> None:
    refused(api.post("/estop", headers={"origin": "http://evil.example"}), 403, "evil.example")
    refused(api.get("/state", headers={"host": "evil.example"}), 403, "evil.example")
    own = str(api.base_url).removesuffix("/api/v1/")
    assert api.post("/estop", headers={"origin": own}).status_code == 200


def test_urdf_and_head_camera(api: httpx.Client) -> None:
    assert "<robot" in api.get("/robot/urdf").text
    picture = api.get("/camera/head.jpg")
    assert picture.headers["content-type"] == "image/jpeg" and picture.content[:2] == b"\xff\xd8"


def test_documents_and_metrics(live: tuple[httpx.Client, Engine]) -> None:
    client, _ = live
    root = str(client.base_url).removesuffix("/api/v1/")
    paths = httpx.get(f"{root}/openapi.json").json()["paths"]
    for path in ("health", "state", "config", "recordings", "sessions", "engage", "estop/reset", "robot/command"):
        assert f"/api/v1/{path}" in paths
    assert httpx.get(f"{root}/docs").status_code == 200
    metrics = httpx.get(f"{root}/metrics").text
    assert "teleop_frames_total" in metrics and 'teleop_latency_ms{quantile="0.95",stage="tracking"}' in metrics
    assert httpx.get(f"{root}/").status_code in (200, 503)
    refused(client.get("/no/such/thing"), 404)
    refused(client.put("/estop"), 405)


def test_what_this_robot_cannot_reach_is_refused_with_its_range(api: httpx.Client) -> None:
    refused(api.post("/robot/command", json={"lift_m": 0.9}), 422, "0 <= lift_m <= 0.4")
    arm = {"c1_deg": 170, "c2_deg": 0, "elbow_deg": 10}
    refused(api.post("/robot/command", json={"left_arm": arm}), 422, "left_arm.c1_deg")
    straight = {"c1_deg": 0, "c2_deg": 0, "elbow_deg": 180}
    assert api.post("/robot/command", json={"lift_m": 0.4, "left_arm": straight}).status_code == 200


def test_of_two_changes_at_once_neither_is_lost(api: httpx.Client) -> None:
    before = api.get("/config").json()["teleop"]["intent"]["safety"]
    names = ("stale_s", "future_s")
    with ThreadPoolExecutor(2) as pool:
        for step in range(1, 6):
            patches = [{"teleop": {"intent": {"safety": {name: 0.5 + step / 100}}}} for name in names]
            list(pool.map(lambda patch: api.patch("/config", json=patch).raise_for_status(), patches))
            after = api.get("/config").json()["teleop"]["intent"]["safety"]
            assert [after[name] for name in names] == [0.5 + step / 100] * 2
    api.patch("/config", json={"teleop": {"intent": {"safety": {name: before[name] for name in names}}}})


@pytest.mark.parametrize("name", ["realsense:session.bag", "realsense:session.db3", "openni2:session.oni"])
def test_files_in_the_servers_folder_are_not_opened(api: httpx.Client, name: str) -> None:
    refused(api.post("/sessions", json={"source": name}), 403, "command line only")


def test_an_unknown_scheme_is_told_the_legal_ones(api: httpx.Client) -> None:
    refused(api.post("/sessions", json={"source": "foo:"}), 422, "realsense:")


def test_a_refused_upload_names_the_senders_file_only(live: tuple[httpx.Client, Engine]) -> None:
    client, _ = live
    answer = client.post("/recordings", files={"file": ("broken.mcap", b"no recording")})
    refused(answer, 422, "broken.mcap")
    assert ".part" not in answer.text and "/" not in answer.json()["detail"].split("broken.mcap")[0]
