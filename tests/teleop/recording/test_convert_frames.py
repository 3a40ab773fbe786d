"""Recordings and RGB-D folders, converted into each other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from recording_frames import camera, frames

from teleop.errors import RecordingError, SourceError
from teleop.frames import Camera, DepthFrame, Intrinsics
from teleop.recording import McapSource, McapWriter
from teleop.recording.convert import convert
from teleop.recording.summary import summarise
from teleop.sources.push import PushSource
from teleop.sources.rgbd_folder import RgbdFolderSource

TRANSFORM = ((1.0, 0.0, 0.0, 0.025), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
CAMERA = Camera(camera().depth, True, Intrinsics(50.0, 50.0, 30.0, 20.0, 64, 48), TRANSFORM)


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    path = tmp_path / "a.mcap"
    with McapWriter(path, CAMERA, source_uri="x") as writer:
        for frame in frames(12, cam=CAMERA, color=True):
            writer.write_frame(frame)
    return path


def test_there_and_back_is_bit_equal(recording: Path, tmp_path: Path) -> None:
    seen: list[DepthFrame] = []
    assert convert(McapSource(recording), tmp_path / "folder", on_frame=seen.append) == 12
    assert len(seen) == 12
    folder = RgbdFolderSource(tmp_path / "folder")
    assert folder.info.camera == CAMERA
    assert convert(folder, tmp_path / "b.mcap") == 12
    back = McapSource(tmp_path / "b.mcap")
    assert back.info.camera == CAMERA
    first = McapSource(recording).frames()
    for original, in_folder, again in zip(first, folder.frames(), back.frames(), strict=True):
        assert original.t_ns == in_folder.t_ns == again.t_ns
        np.testing.assert_array_equal(original.depth_mm, in_folder.depth_mm)
        np.testing.assert_array_equal(original.depth_mm, again.depth_mm)
        assert in_folder.color_rgb is not None and original.color_rgb is not None
        np.testing.assert_array_equal(original.color_rgb, in_folder.color_rgb)


def test_a_part_and_without_colour(recording: Path, tmp_path: Path) -> None:
    assert convert(McapSource(recording), tmp_path / "f", color=False, from_s=0.1, seconds=0.1) == 4
    assert not (tmp_path / "f" / "rgb").exists()
    assert [f.t_ns for f in RgbdFolderSource(tmp_path / "f").frames()] == [f.t_ns for f in frames(12)[4:8]]


def test_nothing_is_overwritten_without_force(recording: Path, tmp_path: Path) -> None:
    for output in (tmp_path / "f", tmp_path / "b.mcap"):
        convert(McapSource(recording), output)
        with pytest.raises(RecordingError, match="exists already; add --force"):
            convert(McapSource(recording), output)
        convert(McapSource(recording), output, force=True, from_s=0.19)
    assert RgbdFolderSource(tmp_path / "f").info.frame_count == 6
    assert McapSource(tmp_path / "b.mcap").info.frame_count == 6
    with pytest.raises(RecordingError, match="is the source itself"):
        convert(McapSource(recording), recording, force=True)
    (tmp_path / "f" / "thesis.tex").touch()
    with pytest.raises(RecordingError, match=r"holds more than images of a session \(thesis.tex\)"):
        convert(McapSource(recording), tmp_path / "f", force=True)
    with pytest.raises(RecordingError, match="no folder"):
        convert(McapSource(recording), tmp_path / "none" / "b.mcap")
    (tmp_path / "empty").mkdir()
    convert(McapSource(recording), tmp_path / "empty")


def test_a_conversion_that_fails_leaves_nothing_behind(recording: Path, tmp_path: Path) -> None:
    convert(McapSource(recording), tmp_path / "f")
    (tmp_path / "f" / "depth" / "000007.png").write_bytes(b"broken")
    before = sorted(tmp_path.iterdir())
    with pytest.raises(SourceError, match="damaged"):
        convert(RgbdFolderSource(tmp_path / "f"), tmp_path / "b.mcap")
    with pytest.raises(RecordingError, match="no frames from 99"):
        convert(McapSource(recording), tmp_path / "g", from_s=99.0)
    assert sorted(tmp_path.iterdir()) == before


def test_a_live_source_needs_an_end(tmp_path: Path) -> None:
    source = PushSource(camera(), capacity=10)
    with pytest.raises(RecordingError, match="how many seconds"):
        convert(source, tmp_path / "a.mcap")
    for frame in frames(8):
        source.feed(frame)
    source.close()
    assert convert(source, tmp_path / "a.mcap", seconds=0.1) == 4


def test_the_summary_tells_what_is_there(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    made = frames(30, color=True)
    del made[10:15]
    with McapWriter(path, camera(), source_uri="virtual:") as writer:
        for i, frame in enumerate(made):
            depth = np.full_like(frame.depth_mm, 1000 + i)
            depth[:24] = 0
            writer.write_frame(DepthFrame(frame.t_ns, depth, frame.camera, frame.color_rgb if i % 2 else None))
    summary = summarise(McapSource(path))
    assert (summary.frames, summary.color_frames, summary.gaps) == (25, 25, 1)
    assert summary.longest_gap_s == pytest.approx(0.2)
    assert summary.rate_hz == pytest.approx(30.0)
    assert (summary.depth_min_mm, summary.depth_median_mm, summary.depth_max_mm) == (1000, 1012, 1024)
    assert summary.valid_fraction == 0.5
    assert summary.size_bytes == path.stat().st_size
    assert summary.topics["/camera/depth/image_raw"].messages == 25
    assert summary.topics["/camera/depth/image_raw"].schema == "foxglove.RawImage"
    assert summary.metadata["source"] == "virtual:"
