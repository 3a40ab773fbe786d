"""The settings tree: layers, and refusals that name the legal range."""

from pathlib import Path

import pytest

from robot_sim.errors import RobotError
from server.errors import SettingsError
from server.settings import Settings, changed, load_settings


def test_flags_win_over_the_environment_and_that_over_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "teleop.toml"
    file.write_text("port = 9001\nloop = false\n[stream]\nstate_hz = 10.0\njpeg_quality = 70\n")
    monkeypatch.setenv("TELEOP_STREAM__STATE_HZ", "20")
    monkeypatch.setenv("TELEOP_PORT", "9002")
    settings = load_settings(file, {"port": 9003, "loop": None})
    assert settings.port == 9003
    assert settings.loop is False
    assert (settings.stream.state_hz, settings.stream.jpeg_quality) == (20.0, 70)


@pytest.mark.parametrize(
    ("patch", "words"),
    [
        ({"port": 70000}, ["port", "70000", "1 <= value <= 65535"]),
        ({"stream": {"jpeg_quality": 5}}, ["stream.jpeg_quality", "30 <= value <= 100"]),
        ({"teleop": {"intent": {"zones": {"l1_m": 99}}}}, ["teleop.intent.zones.l1_m", "0.4 <= value <= 5.0"]),
        ({"strem": {}}, ["strem", "no such setting", "stream"]),
        ({"stream": {"hz": 1}}, ["stream.hz", "no such setting", "state_hz"]),
        ({"stream": 3}, ["stream"]),
    ],
)
def test_a_refusal_names_the_setting_and_what_is_legal(patch: dict[str, object], words: list[str]) -> None:
    with pytest.raises(SettingsError) as refusal:
        changed(Settings(), patch)
    text = str(refusal.value)
    assert "\n" not in text
    assert all(word in text for word in words), text


def test_a_refused_change_changes_nothing_and_a_good_one_keeps_the_rest() -> None:
    settings = Settings()
    with pytest.raises(SettingsError):
        changed(settings, {"stream": {"state_hz": 15.0, "jpeg_quality": 5}})
    assert settings == Settings()
    after = changed(settings, {"stream": {"state_hz": 15.0}})
    assert after.stream.state_hz == 15.0
    assert after.stream.model_copy(update={"state_hz": 30.0}) == settings.stream


def test_a_scenario_brings_robot_crop_and_start_and_says_what_does_not_go_with_it(tmp_path: Path) -> None:
    settings = load_settings(None, {"scenario": "pick_grapes"})
    assert settings.robot.tool.gripper == "soft"
    assert settings.robot.start.beside_fruit == "grape_3_fruit_0"
    with pytest.raises(RobotError, match="no scenario 'magnet'; give a TOML file or one of: pick_grapes"):
        load_settings(None, {"scenario": "magnet"})
    with pytest.raises(SettingsError, match="needs the simulation"):
        load_settings(None, {"scenario": "pick_one", "drives": "serial:/dev/null"})
    file = tmp_path / "teleop.toml"
    file.write_text('scenario = "pick_one"\n[robot.pick]\nhold_s = 1.0\n')
    with pytest.raises(SettingsError, match="brings its own robot"):
        load_settings(file)


@pytest.mark.parametrize("content", ["port = ", "\xff\xfe", None])
def test_a_file_that_is_no_toml_is_one_clear_line(tmp_path: Path, content: str | None) -> None:
    file = tmp_path / "bad.toml"
    if content is not None:
        file.write_bytes(content.encode("latin-1"))
    with pytest.raises(SettingsError, match=r"bad\.toml") as refusal:
        load_settings(file)
    assert "\n" not in str(refusal.value)
