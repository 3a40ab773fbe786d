"""RGB-D folders: what is read, and one clear line for what cannot be."""

from __future__ import annotations

import json
import logging
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from teleop.data import data_root
from teleop.errors import SourceError
from teleop.sources import open_source
from teleop.sources.rgbd_folder import RgbdFolderSource

CAMERA = {"fx": 50, "fy": 50, "cx": 31.5, "cy": 23.5, "width": 64, "height": 48, "depth_scale": 1000}


def make_folder(
    folder: Path, camera: dict[str, Any] | None = CAMERA, depth: Any = None, lists: bool = True, rgb: bool = False
) -> Path:
    (folder / "depth").mkdir(parents=True)
    images = depth if depth is not None else [np.full((48, 64), 1000 + i, np.uint16) for i in range(4)]
    lines = []
    for i, image in enumerate(images):
        cv2.imwrite(str(folder / "depth" / f"{i}.png"), image)
        lines.append(f"{10 + i / 10:.6f} depth/{i}.png\n")
    if camera is not None:
        (folder / "camera.json").write_text(json.dumps(camera))
    if lists:
        (folder / "depth.txt").write_text("# seconds path\n" + "".join(lines))
    if rgb:
        (folder / "rgb").mkdir()
        for i in range(3):
            cv2.imwrite(str(folder / "rgb" / f"{i}.png"), np.full((48, 64, 3), (10 * i, 0, 200), np.uint8))
        (folder / "rgb.txt").write_text("10.010 rgb/0.png\n10.130 rgb/1.png\n10.400 rgb/2.png\n")
    return folder


def test_times_depth_and_colour(tmp_path: Path) -> None:
    source = open_source(str(make_folder(tmp_path / "f", {**CAMERA, "mirrored": True}, rgb=True)))
    assert (source.info.kind, source.info.frame_count, source.info.camera.mirrored) == ("rgbd_folder", 4, True)
    assert source.info.duration_s == pytest.approx(0.3)
    frames = list(source.frames())
    assert [f.t_ns for f in frames] == [10_000_000_000, 10_100_000_000, 10_200_000_000, 10_300_000_000]
    assert [int(f.depth_mm[0, 0]) for f in frames] == [1000, 1001, 1002, 1003]
    # RGB order; each depth image takes the nearest colour image within half a frame of the slower camera (98 ms here).
    blues = [None if f.color_rgb is None else int(f.color_rgb[0, 0, 2]) for f in frames]
    assert blues == [0, 10, 10, None]
    assert frames[0].color_rgb is not None and frames[0].color_rgb[0, 0, 0] == 200
    assert [f.seq for f in source.frames(0.15)] == [2, 3]


@pytest.mark.parametrize(("scale", "raw", "mm"), [(1000, 1234, 1234), (5000, 12345, 2469), (100, 60000, 0)])
def test_depth_scale(tmp_path: Path, scale: float, raw: int, mm: int) -> None:
    folder = make_folder(tmp_path / "f", {**CAMERA, "depth_scale": scale}, [np.full((48, 64), raw, np.uint16)])
    frame = next(RgbdFolderSource(folder).frames())
    assert frame.depth_mm.dtype == np.uint16
    assert (frame.depth_mm == mm).all()


def test_without_camera_json_the_tum_defaults_apply_with_a_warning(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    folder = make_folder(tmp_path / "f", None, [np.full((240, 320), 5000, np.uint16)])
    with caplog.at_level(logging.WARNING):
        source = RgbdFolderSource(folder)
    assert "no camera.json" in caplog.text
    k = source.info.camera.depth
    assert (k.fx, k.cx, k.width) == (262.5, 159.5, 320)
    assert (next(source.frames()).depth_mm == 1000).all()


def test_without_lists_names_give_the_order(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    folder = make_folder(tmp_path / "f", lists=False)
    assert [f.t_ns for f in RgbdFolderSource(folder).frames()] == [0, 33_333_333, 66_666_666, 99_999_999]
    assert "30 frames/s" in caplog.text
    for i, seconds in enumerate(("1305031102.160407", "1305031102.194330", "1305031102.226738", "1305031102.262886")):
        (folder / "depth" / f"{i}.png").rename(folder / "depth" / f"{seconds}.png")
    times = [f.t_ns for f in RgbdFolderSource(folder).frames()]
    assert times[:2] == [1305031102160407000, 1305031102194330000]


def test_colour_camera_with_its_own_view(tmp_path: Path) -> None:
    matrix = [[1, 0, 0, 0.025], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    color = {"fx": 525, "fy": 525, "cx": 320, "cy": 240, "width": 640, "height": 480, "T_color_depth": matrix}
    camera = RgbdFolderSource(make_folder(tmp_path / "f", {**CAMERA, "color": color})).info.camera
    assert camera.color is not None and camera.color.fx == 525
    assert camera.T_color_depth is not None and camera.T_color_depth[0][3] == 0.025


SIZES = [np.ones((48, 64), np.uint16), np.ones((24, 32), np.uint16)]


@pytest.mark.parametrize(
    ("made", "words"),
    [
        ({"depth": []}, "has no depth"),
        ({"depth": [np.ones((48, 64), np.uint8)]}, "0.png is an uint8 image.*16-bit"),
        ({"depth": [np.ones((48, 64, 3), np.uint16)]}, "of 3 channel"),
        ({"depth": SIZES}, "1.png is 32x24 but the camera is 64x48"),
        ({"camera": {**CAMERA, "width": 640}}, "0.png is 64x48 but the camera is 640x48"),
        ({"camera": {**CAMERA, "fx": 0}}, "fx: Input should be greater than 0"),
        ({"camera": {**CAMERA, "fx": "nan"}}, "fx: Input should be a finite number"),
        ({"camera": {**CAMERA, "depth_scale": -1}}, "depth_scale"),
        ({"camera": {**CAMERA, "mirrored": "perhaps"}}, "mirrored"),
        ({"camera": {"fx": 1}}, "fy: Field required"),
        ({"camera": {**CAMERA, "color": {"fx": 1}}}, "color.fy"),
        ({"camera": []}, "content"),
    ],
)
def test_folders_that_cannot_be_used(tmp_path: Path, made: dict[str, Any], words: str) -> None:
    folder = make_folder(tmp_path / "f", **made)
    with pytest.raises(SourceError, match=words) as raised:
        list(RgbdFolderSource(folder).frames())
    assert "\n" not in str(raised.value)


def test_lists_that_cannot_be_used(tmp_path: Path) -> None:
    folder = make_folder(tmp_path / "f")
    for text, words in (
        ("ten depth/0.png", "line 1: expected 'seconds path', got 'ten depth/0.png'"),
        ("10.0 depth/0.png\n10.1", "line 2"),
        ("nan depth/0.png", "line 1"),
        ("1e99 depth/0.png", "line 1"),
        ("1 depth/0.png\n2 depth/8.png\n3 depth/9.png", "lists 2 missing files, the first is .*8.png"),
        ("1 depth/0.png\n1.0 depth/1.png", "same time"),
    ):
        (folder / "depth.txt").write_text(text)
        with pytest.raises(SourceError, match=words):
            RgbdFolderSource(folder)
    (folder / "depth.txt").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(SourceError, match="cannot read"):
        RgbdFolderSource(folder)


def test_damaged_files(tmp_path: Path) -> None:
    folder = make_folder(tmp_path / "f", rgb=True)
    (folder / "rgb" / "1.png").write_bytes(b"broken")
    with pytest.raises(SourceError, match=r"1\.png cannot be read as an image"):
        list(RgbdFolderSource(folder).frames())
    (folder / "depth" / "2.png").write_bytes((folder / "depth" / "2.png").read_bytes()[:40])
    (folder / "rgb.txt").unlink()
    (folder / "rgb" / "1.png").unlink()
    with pytest.raises(SourceError, match=r"2\.png cannot be read as a PNG"):
        list(RgbdFolderSource(folder).frames())
    (folder / "camera.json").write_text("{")
    with pytest.raises(SourceError, match="is not JSON"):
        RgbdFolderSource(folder)


@pytest.mark.data
def test_a_real_kinect(caplog: pytest.LogCaptureFixture) -> None:
    root = data_root()
    if root is None or not (root / "kinect_real").is_dir():
        pytest.skip("data set kinect_real not found (TELEOP_DATA or ../shared/data)")
    source = open_source(str(root / "kinect_real"))
    assert (source.info.frame_count, source.info.camera.mirrored, source.info.has_color) == (2227, True, False)
    frame = next(source.frames(60.0))
    person = frame.depth_mm[frame.depth_mm > 0]
    assert 2000 < np.median(person) < 4000
    assert caplog.text == ""
