"""The examples, each run as its reader would, on the real server and the real tracker."""

from __future__ import annotations

import csv
import runpy
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest
from live_server import running, write_walk

from server.client import TeleopClient

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def example(name: str) -> ModuleType:
    module = ModuleType(name)
    vars(module).update(runpy.run_path(str(EXAMPLES / f"{name}.py")))
    return module


@pytest.fixture(scope="module")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with running(tmp_path_factory.mktemp("examples")) as (url, _):
        yield url


def test_angles_of_a_replayed_session_become_a_table(url: str, tmp_path: Path) -> None:
    output = tmp_path / "angles.csv"
    assert example("replay_angles").main(["walk", str(output), "--seconds", "2", "--url", url]) == 0
    with output.open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) > 5 and all(
        10.0 < float(row["theta3_right"]) <= 180.0 for row in rows if row["theta3_right"] != "nan"
    )
    assert [float(r["position_s"]) for r in rows] == sorted(float(r["position_s"]) for r in rows)


def test_the_robot_drives_and_picks_with_the_lease(url: str, capsys: pytest.CaptureFixture[str]) -> None:
    fruit = "cucumber_4_fruit_0"
    assert example("drive_to_pick").main(["--fruit", fruit, "--url", url]) == 0
    told = capsys.readouterr().out
    assert "m forward first" in told and f"{fruit}: cut" in told and "1 in the box" in told
    with TeleopClient(url) as robot:
        state = robot.state()
        assert state.robot.base.x > 0.5 and state.robot.fruits == {fruit: "boxed"}
        assert abs(state.robot.drive_m_s) < 0.01 and not state.robot.cutter_closed
        assert robot.access().lease.holder is None, "it gave the lease back"


@pytest.mark.parametrize("scenario", ["pick_one", "pick_tomatoes", "pick_grapes"])
def test_a_scenario_is_played_by_a_script(scenario: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert example("pick_by_script").main([scenario]) == 0
    assert "1 in the box, 0 damaged" in capsys.readouterr().out


def test_a_folder_is_tracked_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    write_walk(folder / "one.mcap", 4)
    assert example("retrack_folder").main([str(folder), str(tmp_path / "out"), "--workers", "1"]) == 0
    told = capsys.readouterr().out
    assert "1 recordings tracked" in told and "one.mcap.jsonl: person in 4 frames" in told
