"""Kinect v1 through libfreenect; the same path plays dumps through libfreenect's own fakenect."""

from __future__ import annotations

import ctypes
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from teleop.errors import SourceError
from teleop.frames import Camera, ColorImage, DepthFrame, Intrinsics, kinect_v1
from teleop.sources import freenect_api as api
from teleop.sources.base import SourceInfo
from teleop.sources.kinect_depth import raw_to_mm
from teleop.sources.live import TickClock, increasing
from teleop.sources.registration import Registration

TICKS_PER_S = 60_000_000
"""The Kinect stamps frames with its 60 MHz clock."""
_SHAPE = (480, 640)
_WAIT_US = 100_000
_SILENCE_S = 3.0

COLOR_CAMERA = Intrinsics(525.0, 525.0, 319.5, 239.5, 640, 480)
REGISTERED = Camera(COLOR_CAMERA)
"""Depth registered to colour: both have the colour camera's view."""
UNREGISTERED = Camera(
    kinect_v1(),
    color=COLOR_CAMERA,
    T_color_depth=((1.0, 0.0, 0.0, -0.025), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0)),
)
"""Raw depth: the colour camera sits 25 mm to the right of the depth camera, as seen from behind."""


def _require_dump() -> None:
    """fakenect offers raw depth only, and ends the process when it finds no dump."""
    folder = os.environ.get("FAKENECT_PATH", "")
    if not (Path(folder) / "INDEX.txt").is_file():
        raise SourceError(f"fakenect plays the dump that FAKENECT_PATH names, and '{folder}' holds no INDEX.txt")
    from teleop.sources.fakenect_dump import FakenectDumpSource

    FakenectDumpSource(folder)


class FreenectSource:
    """One Kinect v1, 640x480 at 30 frames/s, in millimetres, not mirrored; registered by the library, else by us."""

    def __init__(self, argument: str = "") -> None:
        """argument: the device's index, 0 when empty. Raises SourceError."""
        if argument and not (argument.isascii() and argument.isdigit()):
            raise SourceError(f"freenect:{argument} must name a device by its index, such as freenect:0")
        self._index = int(argument or "0")
        self._closed = False
        self._depth: tuple[int, bytes] | None = None
        self._color: bytes | None = None
        self._registration = Registration(UNREGISTERED)
        self._library = api.load()
        self._context = api.open_context(self._library)
        self._device = ctypes.c_void_p()
        try:
            self._open()
        except SourceError:
            self._library.freenect_shutdown(self._context)
            raise
        self._info = SourceInfo(
            uri=f"freenect:{argument}",
            kind="freenect",
            camera=self._registration.camera if self._raw else REGISTERED,
            live=True,
            has_color=True,
        )

    @property
    def info(self) -> SourceInfo:
        """What is known of the device."""
        return self._info

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:  # noqa: ARG002
        """Frames as they come, stamped by the Kinect's own clock from 0 on. Raises SourceError when it stops."""
        return increasing(self._read())

    def close(self) -> None:
        """Stop the streams and release the device; safe to call twice."""
        if not self._closed:
            self._closed = True
            self._library.freenect_stop_depth(self._device)
            self._library.freenect_stop_video(self._device)
            self._library.freenect_close_device(self._device)
            self._library.freenect_shutdown(self._context)

    def _open(self) -> None:
        lib = self._library
        count = lib.freenect_num_devices(self._context)
        if self._index >= count:
            raise SourceError(
                f"no Kinect v1 at index {self._index}, {count} found; check its power supply and USB, "
                "or run 'teleop doctor'"
            )
        if lib.freenect_open_device(self._context, ctypes.byref(self._device), self._index) < 0:
            raise SourceError(f"the Kinect at index {self._index} cannot be opened; run 'teleop doctor'")
        depth, video = api.depth_modes(lib), api.video_modes(lib)
        self._raw = api.DEPTH_REGISTERED not in depth
        if self._raw:
            _require_dump()
        mode = depth.get(api.DEPTH_11BIT if self._raw else api.DEPTH_REGISTERED)
        if mode is None or api.VIDEO_RGB not in video:
            raise SourceError("this libfreenect offers no 640x480 depth and colour; install libfreenect 0.5.3 or newer")
        # Kept as long as the source: the library calls them from process_events.
        self._callbacks = (api.IMAGE_CALLBACK(self._take_depth), api.IMAGE_CALLBACK(self._take_color))
        lib.freenect_set_depth_callback(self._device, self._callbacks[0])
        lib.freenect_set_video_callback(self._device, self._callbacks[1])
        failed = (
            lib.freenect_set_depth_mode(self._device, mode) < 0
            or lib.freenect_set_video_mode(self._device, video[api.VIDEO_RGB]) < 0
            or lib.freenect_start_depth(self._device) < 0
            or lib.freenect_start_video(self._device) < 0
        )
        if failed:
            lib.freenect_close_device(self._device)
            raise SourceError(f"the Kinect at index {self._index} does not start its streams; unplug and plug it again")

    def _take_depth(self, _device: Any, image: int, ticks: int) -> None:
        self._depth = (ticks, ctypes.string_at(image, _SHAPE[0] * _SHAPE[1] * 2))

    def _take_color(self, _device: Any, image: int, _ticks: int) -> None:
        self._color = ctypes.string_at(image, _SHAPE[0] * _SHAPE[1] * 3)

    def _read(self) -> Iterator[DepthFrame]:
        clock = TickClock(TICKS_PER_S)
        wait = api.TimeVal(0, _WAIT_US)
        heard_s = time.monotonic()
        seq = 0
        while not self._closed:
            alive = self._library.freenect_process_events_timeout(self._context, ctypes.byref(wait)) >= 0
            if not alive or time.monotonic() - heard_s > _SILENCE_S:
                raise SourceError(f"the Kinect at index {self._index} gives no more images; check its cable and power")
            if self._depth is None:
                continue
            heard_s = time.monotonic()
            ticks, data = self._depth
            self._depth = None
            depth = np.frombuffer(data, dtype=np.uint16).reshape(_SHAPE)
            depth_mm = raw_to_mm(depth) if self._raw else depth
            color = self._newest_color()
            if self._raw and color is not None:
                color = self._registration(depth_mm, color)
            yield DepthFrame(clock.t_ns(ticks), depth_mm, self._info.camera, color, seq)
            seq += 1

    def _newest_color(self) -> ColorImage | None:
        if self._color is None:
            return None
        return np.frombuffer(self._color, dtype=np.uint8).reshape(*_SHAPE, 3)
