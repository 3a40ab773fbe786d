"""Operators over the API and the command line: written, chosen, removed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from cli_process import one_error_line, teleop
from live_server import running

PROFILE = {"handedness": "left", "bones_m": {"forearm": 0.25}, "thresholds": {"task.T1_deg": 10.0}}


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    folder = tmp_path_factory.mktemp("operators")
    with (
        running(folder, operators=str(folder / "profiles")) as (url, _),
        httpx.Client(base_url=f"{url}/api/v1", timeout=20) as client,
    ):
        yield client


def test_a_chosen_profile_is_in_force_until_another_is(api: httpx.Client) -> None:
    assert api.get("/operators").json() == {"names": [], "chosen": ""}
    assert api.put("/operators/Ann", json=PROFILE).status_code == 200
    assert api.put("/operators/Bo", json={"handedness": "right"}).status_code == 200
    assert api.get("/operators/ann").json()["bones_m"] == {"forearm": 0.25}
    assert api.post("/operators/chosen", json={"name": "ann"}).json() == {"names": ["Ann", "Bo"], "chosen": "Ann"}
    assert api.get("/config").json()["teleop"]["operator"]["thresholds"] == {"task.T1_deg": 10.0}
    api.post("/operators/chosen", json={"name": "Bo"})
    assert api.get("/config").json()["teleop"]["operator"]["thresholds"] == {}, "nothing of Ann is left"
    assert api.delete("/operators/bo").status_code == 409
    assert api.post("/operators/chosen", json={}).json()["chosen"] == ""
    assert api.delete("/operators/bo").status_code == 204
    assert api.get("/operators").json()["names"] == ["Ann"]


def test_wrong_requests_are_told_what_is_legal(api: httpx.Client) -> None:
    unknown = api.post("/operators/chosen", json={"name": "zoe"})
    assert unknown.status_code == 404 and "no operator 'zoe'" in unknown.json()["detail"]
    assert api.get("/operators/zoe").status_code == api.delete("/operators/zoe").status_code == 404
    wrong = api.put("/operators/Cy", json={"thresholds": {"task.T1_deg": 99}})
    assert wrong.status_code == 422 and "T1_deg" in wrong.json()["detail"]
    assert api.put("/operators/..%20x", json={}).status_code == 422


def test_the_command_line_keeps_profiles(tmp_path: Path) -> None:
    settings = tmp_path / "settings.toml"
    settings.write_text(f'operators = "{tmp_path / "profiles"}"\n')
    config = ("--config", str(settings))
    assert "no operators" in teleop("operators", "list", *config).stderr
    done = teleop("operators", "set", "Ann", "--left-handed", "--threshold", "task.T1_deg=10", *config)
    assert done.returncode == 0, done.stderr
    assert teleop("operators", "list", *config).stdout == "Ann\n"
    assert '"handedness": "left"' in teleop("operators", "show", "ann", *config).stdout
    wrong = teleop("operators", "set", "Ann", "--threshold", "task.T1_deg=99", *config)
    assert "T1_deg" in one_error_line(wrong)
    unknown = teleop("track", "nowhere.mcap", "-o", str(tmp_path / "x.jsonl"), "--operator", "Zoe", *config)
    assert "known: Ann" in one_error_line(unknown)
