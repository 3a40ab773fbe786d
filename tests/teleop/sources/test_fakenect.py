"""Dumps of fakenect: read by us, and played by libfreenect's own fakenect through the driver of a live Kinect."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from teleop.errors import RecordingError, SourceError
from teleop.frames import Camera, DepthFrame, Intrinsics, kinect_v1, pixels
from teleop.recording.fakenect_writer import FakenectWriter, dump_camera
from teleop.sources import open_source
from teleop.sources.freenect import UNREGISTERED

FAKENECT = Path("/usr/lib/x86_64-linux-gnu/fakenect")
PERIOD_NS = 33_333_333


def session(camera: Camera, count: int = 8) -> list[DepthFrame]:
    """A slope from 0.8 m to 4 m that moves, a strip without readings, colour that tells the frame."""
    k = camera.depth
    slope = np.linspace(800, 4000, k.width)
    made = []
    for i in range(count):
        depth = np.tile(slope + 5 * i, (k.height, 1)).round().astype(np.uint16)
        depth[:, : k.width // 8] = 0
        color = np.full((k.height, k.width, 3), (10 + i, 100, 200), np.uint8)
        made.append(DepthFrame(5_000_000_000 + i * PERIOD_NS, depth, camera, color, i))
    return made


def write(folder: Path, frames: list[DepthFrame]) -> Path:
    writer = FakenectWriter(folder, frames[0].camera)
    for frame in frames:
        writer.write_frame(frame)
    writer.close()
    return folder


def test_a_dump_comes_back_within_the_resolution_of_a_kinect(tmp_path: Path) -> None:
    made = session(Camera(kinect_v1()))
    source = open_source(str(write(tmp_path / "a.fakenect", made)))
    assert (source.info.kind, source.info.frame_count, source.info.camera) == ("fakenect_dump", 8, made[0].camera)
    for frame, read in zip(made, source.frames(), strict=True):
        assert read.t_ns == pytest.approx(frame.t_ns - made[0].t_ns, abs=20)
        assert ((read.depth_mm == 0) == (frame.depth_mm == 0)).all()
        step_mm = frame.depth_mm.astype(float) ** 2 / 342_000
        error_mm = np.abs(read.depth_mm.astype(float) - frame.depth_mm)
        assert (error_mm <= 0.5 * step_mm + 1.0).all()
        np.testing.assert_array_equal(read.color_rgb, frame.color_rgb)
    assert [f.seq for f in source.frames(0.1)] == [4, 5, 6, 7]


def test_small_mirrored_images_become_a_kinects(tmp_path: Path) -> None:
    camera = Camera(Intrinsics(285.0, 285.0, 150.0, 120.0, 320, 240), mirrored=True)
    made = session(camera)
    source = open_source(str(write(tmp_path / "a.fakenect", made)))
    read = next(iter(source.frames()))
    assert source.info.camera == dump_camera(camera)
    assert not source.info.camera.mirrored
    # A point in space still falls on the pixel that shows it.
    point = np.array([0.3, 0.2, 2.0])
    u, v = pixels(point, camera).round().astype(int)
    u2, v2 = pixels(point, source.info.camera).round().astype(int)
    assert abs(int(read.depth_mm[v2, u2]) - int(made[0].depth_mm[v, u])) < 25


def test_a_clock_that_wraps(tmp_path: Path) -> None:
    """The Kinect's 32-bit clock wraps after 71.6 s."""
    made = session(Camera(kinect_v1()), 3)
    near = [DepthFrame(i * 30_000_000_000, f.depth_mm, f.camera) for i, f in enumerate(made)]
    source = open_source(str(write(tmp_path / "a.fakenect", near)))
    assert [f.t_ns for f in source.frames()] == [0, 30_000_000_000, 60_000_000_000]


def test_dumps_that_cannot_be_used(tmp_path: Path) -> None:
    folder = write(tmp_path / "a.fakenect", session(Camera(kinect_v1()), 2))
    index = (folder / "INDEX.txt").read_text()
    depth = sorted(folder.glob("d-*"))
    for text, words in (
        (index + "x-1.0-5.pgm\n", "'x-1.0-5.pgm' is no name"),
        (index + "d-1.0-99999999999.pgm\n", "is no name"),
        (index + "../../etc/passwd\n", "is no name"),
        (index + "d-1.0-5.pgm\n", "names d-1.0-5.pgm, which is missing"),
        ("", "has no depth"),
    ):
        (folder / "INDEX.txt").write_text(text)
        with pytest.raises(SourceError, match=words):
            open_source(str(folder))
    (folder / "INDEX.txt").write_text(index)
    depth[1].write_bytes(b"P5 320 240 65535\n" + bytes(640 * 480 * 2))
    with pytest.raises(SourceError, match="is no 640x480 PGM"):
        list(open_source(str(folder)).frames())
    depth[1].write_bytes(depth[0].read_bytes()[:5000])
    with pytest.raises(SourceError, match="is cut off"):
        open_source(str(folder))
    with pytest.raises(RecordingError, match="4:3"):
        FakenectWriter(tmp_path / "b.fakenect", Camera(Intrinsics(500.0, 500.0, 424.0, 240.0, 848, 480)))


PLAY = """
import hashlib, sys
from teleop.sources import open_source
source = open_source("freenect:0")
assert source.info.live
try:
    for frame in source.frames():
        color = -1 if frame.color_rgb is None else int(frame.color_rgb[240, 320, 0])
        print("FRAME", frame.t_ns, color, hashlib.sha256(frame.depth_mm.tobytes()).hexdigest(), flush=True)
        if frame.seq == 6:
            break
finally:
    source.close()
print("CLOSED", flush=True)
"""


def play(dump: Path) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"LD_LIBRARY_PATH": str(FAKENECT), "FAKENECT_PATH": str(dump)}
    return subprocess.run(
        [sys.executable, "-c", PLAY], env=environment, capture_output=True, text=True, timeout=60, check=False
    )


needs_fakenect = pytest.mark.skipif(
    not (FAKENECT / "libfreenect.so.0.5").exists(),
    reason="libfreenect's fakenect is not installed (apt install libfreenect0.5)",
)


@needs_fakenect
def test_the_live_driver_plays_our_dump(tmp_path: Path) -> None:
    dump = write(tmp_path / "a.fakenect", session(UNREGISTERED))
    result = play(dump)
    assert "CLOSED" in result.stdout, result.stdout + result.stderr
    played = [line.split()[1:] for line in result.stdout.splitlines() if line.startswith("FRAME")]
    assert len(played) == 7
    for (t_ns, color, digest), read in zip(played, open_source(str(dump)).frames(), strict=False):
        assert int(t_ns) == read.t_ns
        assert digest == hashlib.sha256(read.depth_mm.tobytes()).hexdigest()
        assert read.color_rgb is not None and int(color) == int(read.color_rgb[0, 0, 0])


@needs_fakenect
@pytest.mark.parametrize(("edit", "words"), [("missing", "no INDEX.txt"), ("cut", "is cut off")])
def test_a_bad_dump_is_refused_before_fakenect_ends_the_process(tmp_path: Path, edit: str, words: str) -> None:
    dump = tmp_path / "a.fakenect"
    if edit == "cut":
        write(dump, session(UNREGISTERED, 3))
        first = next(dump.glob("d-*"))
        first.write_bytes(first.read_bytes()[:100])
    result = play(dump)
    assert "SourceError: " in result.stderr and words in result.stderr
