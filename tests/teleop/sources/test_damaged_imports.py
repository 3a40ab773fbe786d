"""Damaged and truncated files of every import format: frames or one clear line; no crash, hang or runaway memory."""

from __future__ import annotations

import importlib.util
import json
import struct
import subprocess
import sys
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from oni_file import write_oni

from teleop.errors import RecordingError, SourceError
from teleop.frames import Camera, DepthFrame, Intrinsics, kinect_v1
from teleop.recording import McapWriter
from teleop.recording.fakenect_writer import FakenectWriter
from teleop.recording.rgbd_writer import RgbdFolderWriter
from teleop.sources import open_source
from teleop.sources.picture import decode_image
from teleop.sources.probe import probe

HERE = Path(__file__).parent
SMALL = Camera(Intrinsics(50.0, 50.0, 31.5, 23.5, 64, 48))


def session(camera: Camera, count: int) -> list[DepthFrame]:
    rng = np.random.default_rng(5)
    shape = (camera.depth.height, camera.depth.width)
    return [
        DepthFrame(
            i * 33_333_333,
            rng.integers(500, 4000, shape, dtype=np.uint16),
            camera,
            np.full((*shape, 3), 5 * i, np.uint8),
            i,
        )
        for i in range(count)
    ]


def mcap(folder: Path) -> Path:
    with McapWriter(folder / "a.mcap", SMALL, source_uri="x") as writer:
        for frame in session(SMALL, 30):
            writer.write_frame(frame)
    return folder / "a.mcap"


def rgbd(folder: Path) -> Path:
    writer = RgbdFolderWriter(folder / "rgbd", SMALL)
    for frame in session(SMALL, 4):
        writer.write_frame(frame)
    writer.close()
    return folder / "rgbd"


def fakenect(folder: Path) -> Path:
    writer = FakenectWriter(folder / "a.fakenect", Camera(kinect_v1()))
    for frame in session(Camera(kinect_v1()), 2):
        writer.write_frame(frame)
    writer.close()
    return folder / "a.fakenect"


def oni(folder: Path) -> Path:
    if probe("openni2").library is None:
        pytest.skip("libOpenNI2 or the package openni is not installed")
    write_oni(folder / "a.oni", [f.depth_mm for f in session(SMALL, 8)])
    return folder / "a.oni"


def db3(folder: Path) -> Path:
    if importlib.util.find_spec("pyrealsense2") is None:
        pytest.skip("pyrealsense2 is not installed (extra 'sensors')")
    path = folder / "a.db3"
    command = [sys.executable, str(HERE / "realsense_recording.py"), str(path), "4"]
    made = subprocess.run(command, capture_output=True, text=True, timeout=90, check=False)
    if "RECORDED" not in made.stdout:
        pytest.skip(f"librealsense cannot record here: {made.stderr[-200:]}")
    return path


def bag(folder: Path) -> Path:
    """Nothing here writes a ROS 1 bag; its magic and a record header are what a reader looks at first."""
    if importlib.util.find_spec("pyrealsense2") is None:
        pytest.skip("pyrealsense2 is not installed (extra 'sensors')")
    header = b"".join(
        struct.pack("<I", len(field)) + field
        for field in (
            b"op=\x03",
            b"index_pos=" + struct.pack("<Q", 4117),
            b"conn_count=\1\0\0\0",
            b"chunk_count=\1\0\0\0",
        )
    )
    record = struct.pack("<I", len(header)) + header + struct.pack("<I", 4027) + b" " * 4027
    (folder / "a.bag").write_bytes(b"#ROSBAG V2.0\n" + record + bytes(3000))
    return folder / "a.bag"


@pytest.mark.parametrize(
    ("make", "seeds"),
    [(mcap, 60), (rgbd, 60), (fakenect, 30), (oni, 10), (db3, 5), (bag, 4)],
    ids=lambda v: str(v)[:20],
)
def test_damaged_files(make: Callable[[Path], Path], seeds: int, tmp_path: Path) -> None:
    command = [sys.executable, str(HERE / "fuzz_host.py"), str(make(tmp_path)), str(seeds)]
    child = subprocess.run(command, capture_output=True, text=True, timeout=280, check=False)
    assert child.returncode == 0, child.stderr[-3000:]
    found = json.loads(child.stdout.splitlines()[-1])
    assert found["refused"] > 0
    assert found["peak_mb"] < 900
    for line in found["lines"]:
        assert line and "\n" not in line and len(line) < 500, line


def bomb_png(width: int, height: int) -> bytes:
    """A PNG whose header claims a large 16-bit image and that holds a few zero bytes."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(bytes(10_000)))
        + chunk(b"IEND", b"")
    )


def test_images_that_claim_gigabytes_are_refused(tmp_path: Path) -> None:
    import cv2

    assert decode_image(bomb_png(30_000, 30_000), cv2.IMREAD_UNCHANGED) is None
    folder = rgbd(tmp_path)
    next((folder / "depth").iterdir()).write_bytes(bomb_png(30_000, 30_000))
    with pytest.raises(SourceError, match="cannot be read as a PNG"):
        list(open_source(str(folder)).frames())


def test_a_chunk_that_claims_gigabytes_is_refused(tmp_path: Path) -> None:
    path = mcap(tmp_path)
    data = bytearray(path.read_bytes())
    from teleop.recording import McapSource

    chunk = McapSource(path).file.scan.chunks[0]
    data[chunk.offset + 16 : chunk.offset + 24] = (1 << 40).to_bytes(8, "little")
    path.write_bytes(bytes(data))
    with pytest.raises(RecordingError, match="claims 1099511627776 bytes"):
        list(McapSource(path).frames())
