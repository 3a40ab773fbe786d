"""RGB-D folder: 16-bit depth PNGs, colour images if there are any, lists of times, camera.json."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from teleop.errors import SourceError
from teleop.frames import ColorImage, DepthFrame, DepthImage
from teleop.sources.base import SourceInfo
from teleop.sources.camera_json import CameraFile, read_camera_json, tum_default
from teleop.sources.nearest import NearestInTime
from teleop.sources.picture import read_image
from teleop.sources.rgbd_list import ImageFile, list_images

_log = logging.getLogger(__name__)
_COLOR_SUFFIXES = (".png", ".jpg", ".jpeg")


class RgbdFolderSource:
    """Frames of an RGB-D folder as the design fixes it (the TUM benchmark's layout and a camera.json)."""

    def __init__(self, folder: Path | str) -> None:
        """Read the lists and the first image. Raises SourceError."""
        self.folder = Path(folder)
        if not self.folder.is_dir():
            raise SourceError(f"no folder at {self.folder}")
        self._depth = list_images(self.folder, "depth.txt", "depth", (".png",))
        if not self._depth:
            raise SourceError(f"{self.folder} has no depth: an RGB-D folder holds depth/*.png (16 bit) and depth.txt")
        self._color = list_images(self.folder, "rgb.txt", "rgb", _COLOR_SUFFIXES)
        first = _read_png(self._depth[0].path)
        self._file = self._camera_file(first.shape[1], first.shape[0])
        self._camera = self._file.camera()
        self._t_ns = _times(self._depth)
        self._nearest = NearestInTime(_times(self._color), self._t_ns)
        self._info = SourceInfo(
            uri=str(self.folder),
            kind="rgbd_folder",
            camera=self._camera,
            live=False,
            frame_count=len(self._depth),
            duration_s=(self._depth[-1].t_ns - self._depth[0].t_ns) * 1e-9,
            has_color=bool(self._color),
        )

    @property
    def info(self) -> SourceInfo:
        """What is known of the folder."""
        return self._info

    @property
    def depth_scale(self) -> float:
        """Units per metre of the PNG files."""
        return self._file.depth_scale

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:
        """Frames from ``from_s`` seconds after the first. Raises SourceError at an image that cannot be used."""
        first = int(np.searchsorted(self._t_ns, self._t_ns[0] + round(max(from_s, 0.0) * 1e9)))
        for number in range(first, len(self._depth)):
            image = self._depth[number]
            yield DepthFrame(image.t_ns, self._depth_mm(image.path), self._camera, self._color_near(image.t_ns), number)

    def close(self) -> None:
        """Nothing is held open."""

    def _camera_file(self, width: int, height: int) -> CameraFile:
        path = self.folder / "camera.json"
        if not path.is_file():
            _log.warning("%s has no camera.json; taking the TUM benchmark's Kinect v1 (5000 units/m)", self.folder)
            return tum_default(width, height)
        return read_camera_json(path)

    def _depth_mm(self, path: Path) -> DepthImage:
        raw = _read_png(path)
        k = self._camera.depth
        if raw.shape != (k.height, k.width):
            raise SourceError(
                f"{path} is {raw.shape[1]}x{raw.shape[0]} but the camera is {k.width}x{k.height}; "
                "all depth images must have the size in camera.json"
            )
        if self._file.depth_scale == 1000.0:
            return raw
        # Readings beyond 65 m become "no reading", as 0 is.
        mm = np.rint(raw * (1000.0 / self._file.depth_scale))
        return np.where(mm <= 65535, mm, 0).astype(np.uint16)

    def _color_near(self, t_ns: int) -> ColorImage | None:
        number = self._nearest.index(t_ns)
        if number is None:
            return None
        path = self._color[number].path
        image = read_image(path, cv2.IMREAD_COLOR)
        if image is None:
            raise SourceError(f"{path} cannot be read as an image; it is damaged, restore it or take it out of rgb.txt")
        return cv2.cvtColor(image, cv2.COLOR_BGR2RGB).astype(np.uint8, copy=False)


def _times(images: list[ImageFile]) -> npt.NDArray[np.int64]:
    return np.array([image.t_ns for image in images], dtype=np.int64)


def _read_png(path: Path) -> DepthImage:
    """A 16-bit one-channel PNG as it is. Raises SourceError."""
    image = read_image(path, cv2.IMREAD_UNCHANGED)
    if image is None:
        raise SourceError(f"{path} cannot be read as a PNG; it is damaged, restore it or take it out of depth.txt")
    if image.dtype != np.uint16 or image.ndim != 2:
        channels = 1 if image.ndim == 2 else image.shape[2]
        raise SourceError(
            f"{path} is an {image.dtype} image of {channels} channel(s); depth must be a 16-bit grey PNG "
            "(8-bit depth has lost the distances, export it again as 16 bit)"
        )
    return image.astype(np.uint16, copy=False)
