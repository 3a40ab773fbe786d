"""``teleop study`` as a user runs it."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_process import one_error_line, teleop


def test_a_quick_study_leaves_its_report_and_its_motion(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TELEOP_STUDIES", str(tmp_path / "kept"))
    result = teleop("study", "tomato", "--quick", "--output", tmp_path / "out", timeout_s=180.0)
    assert result.returncode == 0, result.stderr
    assert "voids" in result.stdout and "/motion.html?id=tomato" in result.stdout
    assert (tmp_path / "out" / "README.md").read_text(encoding="utf-8").startswith("# ")
    assert (tmp_path / "kept" / "tomato.mcap").read_bytes() == (tmp_path / "out" / "motion.mcap").read_bytes()
    frames = tmp_path / "frames"
    played = teleop("study", "play", tmp_path / "kept" / "tomato.mcap", "--frames", frames, "--fps", "1")
    assert played.returncode == 0, played.stderr
    assert len(list(frames.glob("*.png"))) == 3


def test_bad_input_is_one_clear_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    line = one_error_line(teleop("study", "tomato", "--quick", "--output", tmp_path / "file"))
    assert str(tmp_path / "file") in line
    assert "no motion at" in one_error_line(teleop("study", "play", tmp_path / "none.mcap"))


def test_wrong_usage_is_code_two() -> None:
    for arguments in (
        ("study", "potato"),
        ("study", "grape", "--trials", "0"),
        ("study", "play"),
        ("study", "play", "a.mcap", "--gui", "--video", "b.mp4"),
    ):
        result = teleop(*arguments)
        assert result.returncode == 2, arguments
        assert "Traceback" not in result.stderr
    assert "/motion.html" in teleop("study", "--help").stdout.replace("\n", " ")
