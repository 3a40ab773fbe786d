"""``teleop convert`` as a user runs it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from cli_process import one_error_line, teleop, write_recording

from teleop.sources import open_source


def test_there_and_back(tmp_path: Path) -> None:
    path = write_recording(tmp_path / "a.mcap")
    for source, output in (("a.mcap", "folder"), ("folder", "b.mcap")):
        result = teleop("convert", tmp_path / source, tmp_path / output)
        assert result.returncode == 0, result.stderr
        assert result.stdout.startswith("30 frames written to")
    for first, second in zip(
        open_source(str(path)).frames(), open_source(str(tmp_path / "b.mcap")).frames(), strict=True
    ):
        assert first.t_ns == second.t_ns
        np.testing.assert_array_equal(first.depth_mm, second.depth_mm)
        assert first.camera == second.camera


def test_refusals_are_one_line_and_leave_no_output(tmp_path: Path) -> None:
    path = write_recording(tmp_path / "a.mcap")
    before = path.read_bytes()
    assert "is the source itself" in one_error_line(teleop("convert", path, path, "--force"))
    assert path.read_bytes() == before
    write_recording(tmp_path / "b.mcap", 3)
    assert "--force" in one_error_line(teleop("convert", path, tmp_path / "b.mcap"))
    assert teleop("convert", path, tmp_path / "b.mcap", "--force").returncode == 0
    assert "no recording at" in one_error_line(teleop("convert", tmp_path / "none.mcap", tmp_path / "c"))
    assert "legal are" in one_error_line(teleop("convert", "webcam:0", tmp_path / "c"))
    assert "no folder" in one_error_line(teleop("convert", path, tmp_path / "x" / "c.mcap"))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.mcap", "b.mcap"]
    assert teleop("convert", path).returncode == 2


def test_an_endless_source_needs_seconds(tmp_path: Path) -> None:
    assert "push:" in one_error_line(teleop("convert", "push:", tmp_path / "c.mcap"))
    result = teleop("convert", "virtual:", tmp_path / "c.mcap", "--seconds", "0.3")
    assert result.returncode == 0, result.stderr
    assert open_source(str(tmp_path / "c.mcap")).info.frame_count
