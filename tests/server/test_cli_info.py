"""``teleop info`` as a user runs it."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from cli_process import one_error_line, teleop, write_recording


def test_the_table_and_the_json_tell_the_same(tmp_path: Path) -> None:
    path = write_recording(tmp_path / "a.mcap")
    table = teleop("info", path)
    assert table.returncode == 0, table.stderr
    assert "64x48" in table.stdout and "mirrored" in table.stdout and "30 in 0.97 s" in table.stdout
    assert "/camera/depth/image_raw" in table.stdout and "made here" in table.stdout
    found = json.loads(teleop("info", path, "--json").stdout)
    assert (found["kind"], found["frames"], found["color_frames"]) == ("mcap", 30, 30)
    assert found["rate_hz"] == pytest.approx(30.0)
    assert found["metadata"]["format_version"] == "2"


def test_a_truncated_recording_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    path = write_recording(tmp_path / "a.mcap", 90)
    path.write_bytes(path.read_bytes()[: path.stat().st_size * 2 // 3])
    result = teleop("info", path, "--json")
    assert result.returncode == 0
    assert "last complete chunk" in result.stderr and "Traceback" not in result.stderr
    found = json.loads(result.stdout)
    assert 30 <= found["frames"] < 90
    assert found["truncated"]


def test_bad_input_is_one_clear_line(tmp_path: Path) -> None:
    assert "no recording at" in one_error_line(teleop("info", tmp_path / "none.mcap"))
    (tmp_path / "stub.mcap").write_bytes(write_recording(tmp_path / "a.mcap").read_bytes()[:30])
    assert "no complete chunk" in one_error_line(teleop("info", tmp_path / "stub.mcap"))
    (tmp_path / "text.mcap").write_text("no recording")
    assert "not an MCAP" in one_error_line(teleop("info", tmp_path / "text.mcap"))
    (tmp_path / "folder").mkdir()
    assert "has no depth" in one_error_line(teleop("info", tmp_path / "folder"))
    assert "legal are" in one_error_line(teleop("info", "webcam:0"))


def test_depth_of_the_wrong_kind_or_size(tmp_path: Path) -> None:
    depth = tmp_path / "f" / "depth"
    depth.mkdir(parents=True)
    cv2.imwrite(str(depth / "0.png"), np.ones((48, 64), np.uint8))
    assert "16-bit" in one_error_line(teleop("info", tmp_path / "f"))
    cv2.imwrite(str(depth / "0.png"), np.ones((48, 64), np.uint16))
    camera = {"fx": 500, "fy": 500, "cx": 320, "cy": 240, "width": 640, "height": 480}
    (tmp_path / "f" / "camera.json").write_text(json.dumps(camera))
    assert "is 64x48 but the camera is 640x480" in one_error_line(teleop("info", tmp_path / "f"))


def test_wrong_usage_is_code_two() -> None:
    for arguments in (("info",), ("info", "a", "--seconds", "-1")):
        result = teleop(*arguments)
        assert result.returncode == 2
        assert "Traceback" not in result.stderr
    assert teleop("info", "--help").returncode == 0
