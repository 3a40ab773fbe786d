"""A software device of the real librealsense, recorded to .db3 and played through our driver's pipeline."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from realsense_recording import color_rgb, depth_mm

HERE = Path(__file__).parent
COUNT = 10

pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("pyrealsense2") is None, reason="pyrealsense2 is not installed (extra 'sensors')"
)

CONVERT = """
import sys
from pathlib import Path
from teleop.recording.convert import convert
from teleop.sources import open_source
source = open_source(sys.argv[1])
print("INFO", source.info.camera.depth.fx, source.info.camera.depth.fy, source.info.live, flush=True)
print("FRAMES", convert(source, Path(sys.argv[2]), from_s=float(sys.argv[3])), flush=True)
"""


def run(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *command], capture_output=True, text=True, timeout=90, check=False)


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("realsense") / "a.db3"
    result = run(str(HERE / "realsense_recording.py"), str(path), str(COUNT))
    if "RECORDED" not in result.stdout:
        pytest.skip(f"librealsense cannot record here: {result.stderr[-200:]}")
    return path


def test_the_file_plays_with_its_own_colour_images(recording: Path, tmp_path: Path) -> None:
    from teleop.recording import McapSource

    result = run("-c", CONVERT, str(recording), str(tmp_path / "a.mcap"), "0")
    assert f"FRAMES {COUNT}" in result.stdout, result.stdout + result.stderr
    assert "INFO 600.0 601.0 False" in result.stdout
    for number, frame in enumerate(McapSource(tmp_path / "a.mcap").frames()):
        assert frame.t_ns == (1000 + 33 * number) * 1_000_000
        np.testing.assert_array_equal(frame.depth_mm, depth_mm(number))
        assert frame.color_rgb is not None
        assert np.abs(frame.color_rgb.astype(int) - color_rgb(number)).mean() < 4


def test_a_part_of_the_file(recording: Path, tmp_path: Path) -> None:
    result = run("-c", CONVERT, str(recording), str(tmp_path / "a.mcap"), "0.1")
    assert f"FRAMES {COUNT - 4}" in result.stdout, result.stdout + result.stderr


@pytest.mark.parametrize("part", [0.1, 0.6, 0.95])
def test_a_file_cut_off_is_one_clear_error_or_its_first_frames(recording: Path, tmp_path: Path, part: float) -> None:
    data = recording.read_bytes()
    cut = tmp_path / "cut.db3"
    cut.write_bytes(data[: int(part * len(data))])
    result = run("-c", CONVERT, str(cut), str(tmp_path / "a.mcap"), "0")
    assert "SourceError: realsense:" in result.stderr or "FRAMES" in result.stdout
