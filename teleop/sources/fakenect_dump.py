"""Dumps of libfreenect's ``fakenect-record``: raw 11-bit depth (PGM), colour (PPM) and accelerometer files.

INDEX.txt names the files in order, each ``TYPE-SECONDS-TICKS[-SIZE].EXT`` with TYPE d, r or a; images are one header
line and then the buffer as the library gave it (little endian, whatever PGM says). A camera.json beside the index,
as our own exporter writes it, tells the camera; else it is a Kinect v1's.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from teleop.errors import SourceError
from teleop.frames import Camera, ColorImage, DepthFrame
from teleop.sources.base import SourceInfo
from teleop.sources.camera_json import read_camera_json
from teleop.sources.freenect import TICKS_PER_S, UNREGISTERED
from teleop.sources.kinect_depth import raw_to_mm
from teleop.sources.live import TickClock
from teleop.sources.nearest import NearestInTime

INDEX: Final = "INDEX.txt"
_NAME = re.compile(r"^([dra])-\d+(?:\.\d+)?-(\d{1,10})(?:-\d+)?\.\w+$")
_SHAPE = (480, 640)
_MAX_HEADER_BYTES = 64


class FakenectDumpSource:
    """Frames of a dump folder, in millimetres, stamped by the Kinect's clock from 0 on."""

    def __init__(self, folder: Path | str) -> None:
        """Check the index and every file's size. Raises SourceError."""
        self.folder = Path(folder)
        depth, color = self._read_index()
        self._depth = _checked(depth, 2)
        self._color = _checked(color, 3)
        if not self._depth:
            raise SourceError(f"{self.folder} has no depth: {INDEX} names no d- file")
        self._t_ns = np.array([t for t, _ in self._depth], dtype=np.int64)
        color_t_ns = np.array([t for t, _ in self._color], dtype=np.int64)
        self._nearest = NearestInTime(color_t_ns, self._t_ns)
        self._info = SourceInfo(
            uri=str(self.folder),
            kind="fakenect_dump",
            camera=self._camera(),
            live=False,
            frame_count=len(self._depth),
            duration_s=float(self._t_ns[-1] - self._t_ns[0]) * 1e-9,
            has_color=bool(self._color),
        )

    @property
    def info(self) -> SourceInfo:
        """What is known of the dump."""
        return self._info

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:
        """Frames from ``from_s`` seconds after the first. Raises SourceError at a file that cannot be read."""
        first = int(np.searchsorted(self._t_ns, self._t_ns[0] + round(max(from_s, 0.0) * 1e9)))
        for number in range(first, len(self._depth)):
            t_ns, path = self._depth[number]
            depth_mm = raw_to_mm(_image(path, np.uint16, 1)[..., 0])
            yield DepthFrame(t_ns, depth_mm, self._info.camera, self._color_near(t_ns), number)

    def close(self) -> None:
        """Nothing is held open."""

    def _read_index(self) -> tuple[list[tuple[int, Path]], list[tuple[int, Path]]]:
        """Times from the first depth image on, and paths, of depth and of colour."""
        try:
            names = (self.folder / INDEX).read_text(encoding="utf-8").split()
        except (OSError, UnicodeDecodeError) as error:
            raise SourceError(f"cannot read {self.folder / INDEX}: {error}") from None
        clock = TickClock(TICKS_PER_S)
        files: dict[str, list[tuple[int, Path]]] = {"d": [], "r": [], "a": []}
        for name in names:
            match = _NAME.match(name)
            if match is None or int(match[2]) >= 1 << 32:
                raise SourceError(f"{self.folder / INDEX}: '{name[:60]}' is no name of a dump's file")
            if match[1] != "a":
                files[match[1]].append((clock.t_ns(int(match[2])), self.folder / name))
        start = files["d"][0][0] if files["d"] else 0
        depth, color = ([(t - start, path) for t, path in files[kind]] for kind in ("d", "r"))
        for kind in (depth, color):
            kind.sort(key=lambda file: file[0])
        # A stalled recorder repeats its last buffer with the same stamp.
        distinct = [file for i, file in enumerate(depth) if i == 0 or file[0] > depth[i - 1][0]]
        return distinct, color

    def _camera(self) -> Camera:
        path = self.folder / "camera.json"
        return read_camera_json(path).camera() if path.is_file() else UNREGISTERED

    def _color_near(self, t_ns: int) -> ColorImage | None:
        number = self._nearest.index(t_ns)
        return None if number is None else _image(self._color[number][1], np.uint8, 3)


def _checked(files: list[tuple[int, Path]], bytes_per_pixel: int) -> list[tuple[int, Path]]:
    least = _SHAPE[0] * _SHAPE[1] * bytes_per_pixel
    for _, path in files:
        if not path.is_file():
            raise SourceError(f"{path.parent / INDEX} names {path.name}, which is missing")
        if path.stat().st_size < least:
            raise SourceError(f"{path} is cut off: it holds less than a 640x480 image")
    return files


def _image(path: Path, kind: type[Any], channels: int) -> npt.NDArray[Any]:
    """(480, 640, channels) behind the header line. Raises SourceError."""
    size = _SHAPE[0] * _SHAPE[1] * channels * np.dtype(kind).itemsize
    try:
        with path.open("rb") as file:
            header = file.readline(_MAX_HEADER_BYTES)
            data = file.read(size)
    except OSError as error:
        raise SourceError(f"cannot read {path}: {error.strerror or error}") from None
    magic = b"P5" if channels == 1 else b"P6"
    if header.split()[:3] != [magic, b"640", b"480"] or len(data) < size:
        raise SourceError(f"{path} is no 640x480 {'PGM' if channels == 1 else 'PPM'} with its header on one line")
    return np.frombuffer(data, dtype=kind).reshape(*_SHAPE, channels)
