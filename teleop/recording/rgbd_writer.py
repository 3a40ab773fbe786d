"""Writes an RGB-D folder: depth/*.png in millimetres, rgb/*.png, depth.txt, rgb.txt, camera.json."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType
from typing import Any, Self, TextIO

import cv2
import numpy.typing as npt

from teleop.errors import RecordingError
from teleop.frames import Camera, DepthFrame
from teleop.recording.resumable import keep_lines
from teleop.sources.camera_json import write_camera_json
from teleop.sources.rgbd_list import seconds_text

_MILLIMETRES = 1000.0
_PNG_FAST = [cv2.IMWRITE_PNG_COMPRESSION, 3]


class RgbdFolderWriter:
    """One RGB-D folder; depth is kept bit for bit, colour losslessly."""

    def __init__(self, folder: Path, camera: Camera) -> None:
        """Create ``folder`` and its camera.json, or go on with what an interrupted writer left in it.

        Raises RecordingError.
        """
        self._folder = folder
        self._number = 0
        try:
            (folder / "depth").mkdir(parents=True, exist_ok=True)
            write_camera_json(folder / "camera.json", camera, _MILLIMETRES)
            self.frames_done = keep_lines(folder / "depth.txt", lambda _: True)
            self._depth_list: TextIO = (folder / "depth.txt").open("a", encoding="utf-8")
            self._rgb_list: TextIO | None = None
            if (folder / "rgb.txt").exists():
                keep_lines(folder / "rgb.txt", lambda line: int(Path(line.split()[1]).stem) < self.frames_done)
                self._rgb_list = (folder / "rgb.txt").open("a", encoding="utf-8")
        except OSError as error:
            raise RecordingError(f"cannot write {folder}: {error.strerror or error}") from None

    def skip(self, frame: DepthFrame) -> None:
        """Pass over the next frame, which is there already."""
        del frame
        self._number += 1

    def write_frame(self, frame: DepthFrame) -> None:
        """Depth and, if the frame has it, colour."""
        name = f"{self._number:06d}.png"
        self._number += 1
        try:
            self._image(f"depth/{name}", frame.depth_mm)
            if frame.color_rgb is not None:
                if self._rgb_list is None:
                    (self._folder / "rgb").mkdir(exist_ok=True)
                    self._rgb_list = (self._folder / "rgb.txt").open("a", encoding="utf-8")
                self._image(f"rgb/{name}", cv2.cvtColor(frame.color_rgb, cv2.COLOR_RGB2BGR))
                self._rgb_list.write(f"{seconds_text(frame.t_ns)} rgb/{name}\n")
                self._rgb_list.flush()
            # last: a frame counts as done from here on
            self._depth_list.write(f"{seconds_text(frame.t_ns)} depth/{name}\n")
            self._depth_list.flush()
        except OSError as error:
            raise RecordingError(f"cannot write {self._folder}: {error.strerror or error}") from None

    def close(self) -> None:
        """Finish the lists; safe to call twice."""
        self._depth_list.close()
        if self._rgb_list is not None:
            self._rgb_list.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _image(self, name: str, image: npt.NDArray[Any]) -> None:
        ok, png = cv2.imencode(".png", image, _PNG_FAST)
        if not ok:
            raise RecordingError(f"image of shape {image.shape} cannot be written as PNG")
        (self._folder / name).write_bytes(png.tobytes())
