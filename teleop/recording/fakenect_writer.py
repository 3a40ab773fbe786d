"""Writes a dump that libfreenect's fakenect plays: a recorded session through the driver of a live Kinect v1.

Depth becomes 11-bit disparity, so it keeps the Kinect's own resolution of z^2 / 342 m and nothing finer, and ends at
10 m. The dump is 640x480 and unmirrored, as a Kinect's is.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from teleop.errors import RecordingError
from teleop.frames import Camera, ColorImage, DepthFrame, Intrinsics
from teleop.recording.resumable import keep_lines
from teleop.sources.camera_json import write_camera_json
from teleop.sources.fakenect_dump import INDEX
from teleop.sources.freenect import TICKS_PER_S
from teleop.sources.kinect_depth import mm_to_raw

_WIDTH, _HEIGHT = 640, 480
_DEPTH_HEADER = b"P5 640 480 65535\n"
_COLOR_HEADER = b"P6 640 480 255\n"


class FakenectWriter:
    """One dump folder."""

    def __init__(self, folder: Path, camera: Camera) -> None:
        """Create ``folder`` and its camera.json, or go on with what an interrupted writer left in it.

        Raises RecordingError.
        """
        k = camera.depth
        if _WIDTH * k.height != _HEIGHT * k.width:
            raise RecordingError(f"a Kinect's images are 4:3, {k.width}x{k.height} cannot become a fakenect dump")
        self._folder = folder
        self._mirrored = camera.mirrored
        try:
            folder.mkdir(parents=True, exist_ok=True)
            write_camera_json(folder / "camera.json", dump_camera(camera), 1000.0)
            self.frames_done = keep_lines(folder / INDEX, lambda _: True, lambda line: line.startswith("d-"))
            self._index = (folder / INDEX).open("a", encoding="utf-8")
        except OSError as error:
            raise RecordingError(f"cannot write {folder}: {error.strerror or error}") from None
        self._first_ns: int | None = None

    def skip(self, frame: DepthFrame) -> None:
        """Pass over the next frame, which is there already."""
        self._first_ns = frame.t_ns if self._first_ns is None else self._first_ns

    def write_frame(self, frame: DepthFrame) -> None:
        """Colour before depth, so that a player has it when the depth comes."""
        self._first_ns = frame.t_ns if self._first_ns is None else self._first_ns
        t_ns = frame.t_ns - self._first_ns
        stamp = f"{t_ns * 1e-9:.6f}-{(t_ns * TICKS_PER_S // 1_000_000_000) & 0xFFFFFFFF}"
        try:
            if frame.color_rgb is not None:
                color = _fit(frame.color_rgb, self._mirrored)
                self._write(f"r-{stamp}.ppm", _COLOR_HEADER + color.tobytes())
            depth = _fit(mm_to_raw(frame.depth_mm), self._mirrored)
            self._write(f"d-{stamp}.pgm", _DEPTH_HEADER + depth.astype("<u2").tobytes())
            self._index.flush()
        except OSError as error:
            raise RecordingError(f"cannot write {self._folder}: {error.strerror or error}") from None

    def close(self) -> None:
        """Finish the index; safe to call twice."""
        self._index.close()

    def _write(self, name: str, data: bytes) -> None:
        (self._folder / name).write_bytes(data)
        self._index.write(name + "\n")


def dump_camera(camera: Camera) -> Camera:
    """The camera of the dump: 640x480, not mirrored."""
    color = camera.color
    T = camera.T_color_depth
    if T is not None and camera.mirrored:
        flip = np.diag([-1.0, 1.0, 1.0, 1.0])
        T = tuple(tuple(float(x) for x in row) for row in flip @ np.array(T) @ flip)
    return replace(
        camera,
        depth=_unmirrored(camera.depth.scaled(_WIDTH, _HEIGHT), camera.mirrored),
        color=None if color is None else _unmirrored(color.scaled(_WIDTH, _HEIGHT), camera.mirrored),
        mirrored=False,
        T_color_depth=T,
    )


def _unmirrored(k: Intrinsics, mirrored: bool) -> Intrinsics:
    return replace(k, cx=k.width - 1 - k.cx) if mirrored else k


def _fit(image: ColorImage | np.ndarray, mirrored: bool) -> np.ndarray:
    """640x480 by repeating or leaving out pixels (disparity must not be averaged), unmirrored."""
    if image.shape[:2] != (_HEIGHT, _WIDTH):
        image = cv2.resize(image, (_WIDTH, _HEIGHT), interpolation=cv2.INTER_NEAREST)
    return np.ascontiguousarray(image[:, ::-1] if mirrored else image)
