"""The run over the API: it counts, begins anew, keeps a latched stop, and is not reset under a recording."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from live_server import running

from server.settings import load_settings


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    with (
        running(tmp_path_factory.mktemp("run")) as (url, _),
        httpx.Client(base_url=f"{url}/api/v1", timeout=20) as client,
    ):
        yield client


def drive(api: httpx.Client) -> float:
    """Drive until the run has counted it; returns the distance."""
    end_s = time.monotonic() + 20.0
    while time.monotonic() < end_s:
        assert api.post("/robot/command", json={"drive_m_s": 0.3, "for_s": 1.0}).status_code == 200
        if (distance_m := float(api.get("/run").json()["distance_m"])) > 0.1:
            return distance_m
        time.sleep(0.1)
    raise AssertionError("the robot did not drive")


def test_a_run_is_counted_and_begins_anew(api: httpx.Client) -> None:
    driven_m = drive(api)
    before = api.get("/run").json()
    assert before["energy_j"] > 0.0 and before["picked"] == 0
    assert set(before["sprayed_l"]) == {"water", "nutrient", "pesticide"}
    # the speeds of the last request may go on for a second
    time.sleep(1.2)
    after = api.post("/run/reset").json()
    assert after["distance_m"] < 0.05 < driven_m
    assert after["time_s"] < before["time_s"]


def test_a_latched_stop_outlives_the_reset(api: httpx.Client) -> None:
    api.post("/estop")
    assert api.post("/run/reset").status_code == 200
    end_s = time.monotonic() + 10.0
    while time.monotonic() < end_s and not api.get("/state").json()["robot"]["estop"]:
        time.sleep(0.05)
    assert api.get("/state").json()["robot"]["estop"]
    api.post("/estop/reset")


def test_no_reset_under_a_recording(api: httpx.Client) -> None:
    session = api.post("/sessions", json={"source": "walk", "loop": True, "record": True}).json()
    refused = api.post("/run/reset")
    assert refused.status_code == 409 and "recording" in refused.json()["detail"]
    api.delete(f"/sessions/{session['id']}")
    assert api.post("/run/reset").status_code == 200


def test_a_scenario_is_played_to_its_goal(tmp_path: Path) -> None:
    settings = load_settings(None, {"scenario": "pick_one", "operators": tmp_path / "operators"})
    given = {"scenario": settings.scenario, "robot": settings.robot.model_dump(), "seed": settings.seed}
    with (
        running(tmp_path, **given) as (url, _),
        httpx.Client(base_url=f"{url}/api/v1", timeout=60) as api,
    ):
        goal = api.get("/run").json()["goal"]
        assert (goal["scenario"], goal["reached"]) == ("pick_one", False)
        assert 0.0 < goal["left_s"] <= 60.0
        fruit = settings.robot.start.beside_fruit
        task = api.post("/tasks/pick", json={"fruit": fruit}).json()
        end_s = time.monotonic() + 120.0
        while (task := api.get(f"/tasks/{task['id']}").json())["ended"] is None:
            assert time.monotonic() < end_s
            time.sleep(0.1)
        assert task["status"] == "succeeded", task["detail"]
        run = api.get("/run").json()
        assert (run["picked"], run["goal"]["reached"]) == (1, True)
        again = api.post("/run/reset").json()
        assert (again["picked"], again["goal"]["reached"]) == (0, False)


def test_the_scenarios_are_listed(api: httpx.Client) -> None:
    listed = {s["name"]: s for s in api.get("/scenarios").json()}
    assert {"pick_one", "pick_tomatoes", "pick_grapes", "spray_square_metre"} <= set(listed)
    assert listed["pick_grapes"]["gripper"] == "soft"
