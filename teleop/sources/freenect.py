"""Kinect v1 through libfreenect's synchronous C API (ctypes); the same path plays fakenect dumps."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from teleop.errors import SourceError
from teleop.frames import Camera, DepthFrame, Intrinsics
from teleop.sources.base import SourceInfo
from teleop.sources.kinect_depth import raw_to_mm
from teleop.sources.live import TickClock, increasing

LIBRARY: Final = "libfreenect.so.0.5"
SYNC_LIBRARY: Final = "libfreenect_sync.so.0.5"
_WIDTH, _HEIGHT = 640, 480
_TICKS_PER_S = 60_000_000
"""The Kinect stamps frames with its 60 MHz clock."""
_VIDEO_RGB = 0
_DEPTH_11BIT = 0
_DEPTH_REGISTERED = 4
_KINECT_COLOR = Intrinsics(525.0, 525.0, 319.5, 239.5, _WIDTH, _HEIGHT)
"""Registered depth has the colour camera's view."""


def device_count() -> int:
    """Number of Kinects. Raises SourceError when the library is missing or cannot reach the USB bus."""
    library = _load(LIBRARY)
    context = ctypes.c_void_p()
    if library.freenect_init(ctypes.byref(context), None) < 0:
        raise SourceError("libfreenect cannot open the USB bus; run 'teleop doctor'")
    try:
        return int(library.freenect_num_devices(context))
    finally:
        library.freenect_shutdown(context)


class FreenectSource:
    """One Kinect v1, 640x480 at 30 frames/s: depth registered to colour, in millimetres, not mirrored."""

    def __init__(self, argument: str = "") -> None:
        """argument: the device's index, 0 when empty. Raises SourceError."""
        if argument and not (argument.isascii() and argument.isdigit()):
            raise SourceError(f"freenect:{argument} must name a device by its index, such as freenect:0")
        self._index = int(argument or "0")
        # fakenect plays raw disparity only, and leaves the process when asked for a device it does not have.
        self._raw = "FAKENECT_PATH" in os.environ
        count = 1 if self._raw else device_count()
        if self._index >= count:
            raise SourceError(
                f"no Kinect v1 at index {self._index}, {count} found; check its power supply and USB, "
                "or run 'teleop doctor'"
            )
        self._sync: Any = _load(SYNC_LIBRARY)
        self._stopped = False
        self._info = SourceInfo(
            uri=f"freenect:{argument}",
            kind="freenect",
            camera=Camera(_KINECT_COLOR),
            live=True,
            has_color=True,
        )

    @property
    def info(self) -> SourceInfo:
        """What is known of the device."""
        return self._info

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:  # noqa: ARG002
        """Frames as they come, stamped by the Kinect's own clock from 0 on."""
        return increasing(self._read())

    def close(self) -> None:
        """Stop the streams; safe to call twice."""
        if not self._stopped:
            self._stopped = True
            self._sync.freenect_sync_stop()

    def _read(self) -> Iterator[DepthFrame]:
        clock = TickClock(_TICKS_PER_S)
        depth_format = _DEPTH_11BIT if self._raw else _DEPTH_REGISTERED
        seq = 0
        while not self._stopped:
            ticks, depth = self._image(self._sync.freenect_sync_get_depth, depth_format, np.uint16, 1)
            _, color = self._image(self._sync.freenect_sync_get_video, _VIDEO_RGB, np.uint8, 3)
            depth_mm = raw_to_mm(depth[..., 0]) if self._raw else depth[..., 0]
            yield DepthFrame(clock.t_ns(ticks), depth_mm, self._info.camera, color, seq)
            seq += 1

    def _image(self, call: Any, image_format: int, kind: type[Any], channels: int) -> tuple[int, npt.NDArray[Any]]:
        """Time in ticks and a copy (480, 640, channels) of the library's buffer."""
        buffer, ticks = ctypes.c_void_p(), ctypes.c_uint32()
        if call(ctypes.byref(buffer), ctypes.byref(ticks), self._index, image_format) != 0 or not buffer.value:
            raise SourceError(f"the Kinect at index {self._index} gives no images; check its cable and power supply")
        item = np.dtype(kind).itemsize
        data = ctypes.string_at(buffer.value, _WIDTH * _HEIGHT * channels * item)
        return ticks.value, np.frombuffer(data, dtype=kind).reshape(_HEIGHT, _WIDTH, channels)


def _load(name: str) -> ctypes.CDLL:
    try:
        return ctypes.CDLL(name)
    except OSError:
        raise SourceError(
            f"{name} is not installed; 'sudo apt install libfreenect0.5' on Debian and Ubuntu, or run 'teleop doctor'"
        ) from None
