"""What running the server needs: logs, readiness, reload, metrics, the documentation without a network."""

from __future__ import annotations

import io
import json
import logging
import re
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from fastapi.testclient import TestClient
from live_server import TOKENS, frames, prepared, tracker, write_walk
from prometheus_client.parser import text_string_to_metric_families

from robot_sim.world import World
from server.app import create_app
from server.engine.engine import Engine
from server.errors import SettingsError
from server.library import Library
from server.logs import JsonLines
from server.settings import Settings, load_settings
from server.stream.hub import Hub

LOCAL = {"base_url": "http://127.0.0.1:8000", "client": ("127.0.0.1", 50000)}


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    folder = tmp_path_factory.mktemp("operations")
    with (
        prepared(folder, library=str(folder / "own")) as (app, _),
        TestClient(app, **LOCAL) as client,  # type: ignore[arg-type]
    ):
        yield client


def test_a_log_line_is_one_json_object() -> None:
    stream = io.StringIO()
    handler = logging.StreamHandler(stream)
    handler.setFormatter(JsonLines())
    log = logging.getLogger("test.json")
    log.addHandler(handler)
    log.propagate = False
    try:
        raise ValueError("a\nb")
    except ValueError:
        log.exception("two\nlines for %s", "Rósa", extra={"address": "192.0.2.7"})
    (line,) = stream.getvalue().splitlines()
    row = json.loads(line)
    assert (row["level"], row["logger"], row["message"]) == ("error", "test.json", "two\nlines for Rósa")
    assert row["address"] == "192.0.2.7" and "ValueError" in row["error"]
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z", row["time"])


def test_ready_only_with_a_source_that_gives_frames(api: TestClient) -> None:
    answer = api.get("/api/v1/ready")
    assert answer.status_code == 503
    assert answer.json() == {
        "ready": False,
        "checks": {"engine": "ok", "source": "no source is open", "recording": "ok", "disk": "ok"},
    }
    api.post("/api/v1/sessions", json={"source": "walk", "loop": True})
    assert api.get("/api/v1/ready").json()["ready"] is True


def test_the_documentation_needs_no_network(api: TestClient) -> None:
    page = api.get("/docs").text
    linked = re.findall(r'(?:src|href)="([^"]+)"', page)
    assert len(linked) >= 3 and not [link for link in linked if not link.startswith("/")]
    for link in linked:
        assert api.get(link).status_code == 200, link
    assert "https://" not in page


def test_every_operation_has_a_name_words_and_its_refusals(api: TestClient) -> None:
    document = api.get("/openapi.json").json()
    found = [(path, verb, op) for path, verbs in document["paths"].items() for verb, op in verbs.items()]
    names = [op["operationId"] for _, _, op in found]
    assert len(set(names)) == len(names) and all(re.fullmatch(r"[a-z_]+", name) for name in names)
    for path, verb, op in found:
        assert op.get("description") and op.get("tags"), path
        assert "403" in op["responses"], path
        if verb != "get" and path not in ("/api/v1/login", "/api/v1/logout"):
            assert {"401", "413", "429"} <= set(op["responses"]) or path.endswith("estop"), path
        body = op.get("requestBody", {}).get("content", {}).get("application/json")
        if body is not None:
            schema = next(iter(body["schema"].get("anyOf", [])), body["schema"])  # a body that may be left out
            named = document["components"]["schemas"].get(schema.get("$ref", "").rsplit("/", 1)[-1], schema)
            assert named.get("examples") or body.get("examples") or _described(named), path
    assert "HTTPValidationError" not in document["components"]["schemas"]


def _described(schema: dict[str, object]) -> bool:
    """A tree of settings shows itself: every value has its words."""
    properties = schema.get("properties")
    return isinstance(properties, dict) and all("description" in p or "$ref" in p for p in properties.values())


def test_metrics_are_what_prometheus_reads(api: TestClient) -> None:
    api.post("/api/v1/replay/seek", json={})
    text = api.get("/metrics").text
    samples = {s.name: s.value for family in text_string_to_metric_families(text) for s in family.samples}
    assert samples["teleop_step_age_seconds"] < 60 and samples["process_resident_memory_bytes"] > 1e7
    assert {
        "teleop_frames_total",
        "teleop_loop_lag_seconds",
        "teleop_lease_held",
        "teleop_messages_replaced_total",
    } <= set(samples)
    assert 'teleop_http_requests_total{method="POST",status="422"}' in text


def test_settings_are_read_again_and_what_cannot_change_is_named(tmp_path: Path) -> None:
    file = tmp_path / "teleop.toml"
    file.write_text("[teleop.intent.zones]\nl1_m = 1.5\n")

    def read() -> Settings:
        return load_settings(file)

    settings = read()
    hub, ready = Hub(4, 100, 10), tracker(settings)
    engine = Engine(settings, ready, World(settings.robot), hub)
    engine.start()
    app = create_app(engine, hub, Library(tmp_path / "own", tmp_path, 10**6), settings, TOKENS, read)
    try:
        with TestClient(app, **LOCAL) as client:  # type: ignore[arg-type]
            assert client.post("/api/v1/config/reload").json() == {"changed": [], "needs_restart": []}
            file.write_text("port = 9000\n[teleop.intent.zones]\nl1_m = 1.45\n[stream]\nstate_hz = 20\n")
            told = client.post("/api/v1/config/reload").json()
            assert told["changed"] == ["teleop.intent.zones.l1_m"]
            assert sorted(told["needs_restart"]) == ["port", "stream.state_hz"]
            assert client.get("/api/v1/config").json()["teleop"]["intent"]["zones"]["l1_m"] == 1.45
            file.write_text("[teleop.intent.zones]\nl1_m = 77\n")
            refused: httpx.Response = client.post("/api/v1/config/reload")
            assert refused.status_code == 422 and "0.4 <= value <= 5.0" in refused.json()["detail"]
            with pytest.raises(SettingsError):
                read()
            assert engine.settings.teleop.intent.zones.l1_m == 1.45, "the old ones stay in force"
    finally:
        engine.stop()


def test_a_recording_of_the_library_starts_by_its_name(tmp_path: Path) -> None:
    from server.opening import located

    path = write_walk(tmp_path / "mine.mcap", 2)
    library = Library(tmp_path, tmp_path / "none", 10**8)
    assert located(library, "mine") == str(path)
    assert located(library, "other") == "other" and located(library, "virtual:") == "virtual:"
    assert len(frames()) > 2
