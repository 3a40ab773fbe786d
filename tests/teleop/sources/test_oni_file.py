"""An .oni file through OpenNI2's own file driver and our source; in child processes: the library may crash on exit."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from oni_file import FOV_RAD, write_oni

from teleop.recording import McapSource
from teleop.sources.probe import probe

CONVERT = """
import os, sys
from pathlib import Path
from teleop.errors import SourceError
from teleop.recording.convert import convert
from teleop.sources import open_source
try:
    source = open_source(sys.argv[1])
    print("FRAMES", [convert(source, Path(f"{sys.argv[2]}{i}.mcap"), from_s=s) for i, s in enumerate((0.0, 0.1))])
    source.close()
except SourceError as error:
    print("SAID", error)
sys.stdout.flush()
os._exit(0)
"""


@pytest.fixture(scope="module", autouse=True)
def openni2() -> None:
    if probe("openni2").library is None:
        pytest.skip("libOpenNI2 or the package openni is not installed")


def convert(path: Path, output: Path) -> str:
    command = [sys.executable, "-c", CONVERT, str(path), str(output)]
    child = subprocess.run(command, capture_output=True, text=True, timeout=90, check=False)
    assert "Traceback" not in child.stderr, child.stderr
    return child.stdout


@pytest.mark.parametrize("mirrored", [False, True])
def test_every_frame_in_order_and_again_from_the_start(tmp_path: Path, mirrored: bool) -> None:
    rng = np.random.default_rng(3)
    images = [rng.integers(0, 9999, (240, 320), dtype=np.uint16) for _ in range(8)]
    write_oni(tmp_path / "a.oni", images, mirrored=mirrored)
    assert "FRAMES [8, 4]" in convert(tmp_path / "a.oni", tmp_path / "out")
    source = McapSource(tmp_path / "out0.mcap")
    k = source.info.camera.depth
    assert (k.width, k.height, source.info.camera.mirrored) == (320, 240, mirrored)
    assert k.fx == pytest.approx(160 / np.tan(FOV_RAD[0] / 2), rel=1e-6)
    for number, frame in enumerate(source.frames()):
        assert frame.t_ns == number * 33_000_000
        np.testing.assert_array_equal(frame.depth_mm, images[number])
    assert [f.t_ns for f in McapSource(tmp_path / "out1.mcap").frames()] == [33_000_000 * i for i in (4, 5, 6, 7)]


@pytest.mark.parametrize("part", [0.01, 0.5, 0.99])
def test_a_file_cut_off_is_one_clear_error(tmp_path: Path, part: float) -> None:
    write_oni(tmp_path / "a.oni", [np.full((24, 32), 900, np.uint16)] * 4)
    data = (tmp_path / "a.oni").read_bytes()
    (tmp_path / "cut.oni").write_bytes(data[: int(part * len(data))])
    assert "cut off or no .oni recording" in convert(tmp_path / "cut.oni", tmp_path / "out")
