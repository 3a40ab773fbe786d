"""Conversions that were interrupted in the middle, run again: the same bytes as without, and not all anew."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from recording_frames import camera, frames

from teleop.frames import Camera, kinect_v1
from teleop.recording import McapSource, McapWriter
from teleop.recording.convert import convert
from teleop.recording.rgbd_writer import RgbdFolderWriter

COUNT = 60
OUTPUTS = {"out": "depth.txt", "out.fakenect": "INDEX.txt"}
_SLOW = """
import signal, sys, time
from pathlib import Path
from teleop.recording import McapSource
from teleop.recording.convert import convert
# a shell that runs the tests in the background has its programs ignore SIGINT
signal.signal(signal.SIGINT, signal.default_int_handler)
convert(McapSource(sys.argv[1]), Path(sys.argv[2]), on_frame=lambda _: time.sleep(0.02))
"""


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("resume") / "a.mcap"
    with McapWriter(path, Camera(kinect_v1(64, 48)), source_uri="x") as writer:
        for frame in frames(COUNT, cam=Camera(kinect_v1(64, 48)), color=True):
            writer.write_frame(frame)
    return path


def contents(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


@pytest.mark.parametrize("name", OUTPUTS)
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_a_conversion_goes_on(recording: Path, tmp_path: Path, name: str, how: signal.Signals) -> None:
    whole, output = tmp_path / "whole" / name, tmp_path / name
    whole.parent.mkdir()
    source = McapSource(recording)
    convert(source, whole)
    partial = tmp_path / f"{name}.partial"
    process = subprocess.Popen([sys.executable, "-c", _SLOW, str(recording), str(output)], stderr=subprocess.DEVNULL)
    listing = partial / OUTPUTS[name]
    deadline = time.monotonic() + 60
    while not listing.exists() or listing.read_text().count("\n") < 10:
        assert process.poll() is None and time.monotonic() < deadline
        time.sleep(0.01)
    process.send_signal(how)
    process.wait()
    assert partial.is_dir() and not output.exists()
    first = min((p for p in partial.rglob("*") if p.suffix in (".png", ".pgm")), key=lambda p: p.stat().st_mtime_ns)
    written_ns = first.stat().st_mtime_ns
    seen: list[object] = []
    assert convert(source, output, on_frame=seen.append) == COUNT == len(seen)
    source.close()
    assert contents(output) == contents(whole)
    kept = next(p for p in output.rglob(first.name) if p.parent.name == first.parent.name or name.endswith("fakenect"))
    assert kept.stat().st_mtime_ns == written_ns  # not written again
    assert not partial.exists()


def test_what_another_conversion_left_is_not_gone_on_with(recording: Path, tmp_path: Path) -> None:
    source = McapSource(recording)

    def interrupt(_: object) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        convert(source, tmp_path / "out", on_frame=interrupt)
    assert (tmp_path / "out.partial" / "rgb").is_dir()
    assert convert(source, tmp_path / "out", color=False) == COUNT
    source.close()
    assert not (tmp_path / "out" / "rgb").exists() and ".resume.json" not in contents(tmp_path / "out")


def test_a_cut_line_and_a_frame_without_its_depth_are_written_anew(tmp_path: Path) -> None:
    """What a power cut in the middle of a frame leaves."""
    taken = frames(4, color=True)
    whole, cut = tmp_path / "whole", tmp_path / "cut"
    with RgbdFolderWriter(whole, camera()) as writer:
        for frame in taken:
            writer.write_frame(frame)
    with RgbdFolderWriter(cut, camera()) as writer:
        for frame in taken[:3]:
            writer.write_frame(frame)
    lines = (cut / "depth.txt").read_text().splitlines(keepends=True)
    (cut / "depth.txt").write_text(lines[0] + lines[1] + lines[2][:7])
    (cut / "depth" / "000002.png").write_bytes(b"half")
    with RgbdFolderWriter(cut, camera()) as writer:
        assert writer.frames_done == 2
        for number, frame in enumerate(taken):
            (writer.skip if number < 2 else writer.write_frame)(frame)
    assert contents(cut) == contents(whole)
