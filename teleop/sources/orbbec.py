"""Orbbec cameras (Femto, Gemini, Astra 2) through ``pyorbbecsdk2``; colour aligned to depth."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from teleop.errors import SourceError
from teleop.frames import Camera, ColorImage, DepthFrame, DepthImage, Intrinsics
from teleop.sources.base import SourceInfo
from teleop.sources.live import import_driver, increasing

_TIMEOUT_MS = 1000
_MISSES = 3
"""Waits without a frame before the camera is given up."""


class OrbbecSource:
    """One Orbbec camera at its default depth mode."""

    def __init__(self, argument: str = "") -> None:
        """argument: a serial number, or empty for the first camera. Raises SourceError."""
        self._ob: Any = import_driver("pyorbbecsdk", "pyorbbecsdk2")
        ob = self._ob
        ob.Context.set_logger_level(ob.OBLogLevel.NONE)
        self._running = False
        try:
            self._pipeline = ob.Pipeline(find_device(ob, argument))
            self._info = self._start(argument)
        except (RuntimeError, ob.OBError) as error:
            raise SourceError(f"orbbec:{argument} cannot be opened: {error}") from None

    @property
    def info(self) -> SourceInfo:
        """What is known of the camera."""
        return self._info

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:  # noqa: ARG002
        """Frames stamped by the camera. Raises SourceError when it stops."""
        return increasing(self._read())

    def close(self) -> None:
        """Stop the pipeline; safe to call twice."""
        if self._running:
            self._running = False
            self._pipeline.stop()

    def _start(self, argument: str) -> SourceInfo:
        ob = self._ob
        config = ob.Config()
        depth = self._pipeline.get_stream_profile_list(ob.OBSensorType.DEPTH_SENSOR).get_default_video_stream_profile()
        config.enable_stream(depth)
        color = self._color_profile()
        if color is not None:
            config.enable_stream(color)
        self._pipeline.start(config)
        self._running = True
        self._align = ob.AlignFilter(align_to_stream=ob.OBStreamType.DEPTH_STREAM) if color is not None else None
        k = depth.get_intrinsic()
        return SourceInfo(
            uri=f"orbbec:{argument}",
            kind="orbbec",
            camera=Camera(Intrinsics(k.fx, k.fy, k.cx, k.cy, depth.get_width(), depth.get_height())),
            live=True,
            has_color=color is not None,
        )

    def _color_profile(self) -> Any | None:
        """An RGB mode, or None on a camera that offers none."""
        ob = self._ob
        try:
            profiles = self._pipeline.get_stream_profile_list(ob.OBSensorType.COLOR_SENSOR)
            return profiles.get_video_stream_profile(640, 0, ob.OBFormat.RGB, 30)
        except (RuntimeError, ob.OBError):
            return None

    def _read(self) -> Iterator[DepthFrame]:
        seq = misses = 0
        while self._running:
            frames = self._pipeline.wait_for_frames(_TIMEOUT_MS)
            depth = frames.get_depth_frame() if frames is not None else None
            if depth is None:
                misses += 1
                if misses >= _MISSES:
                    raise SourceError(f"{self._info.uri}: no depth for {misses} s; check the cable")
                continue
            misses = 0
            color = self._color(frames)
            yield DepthFrame(depth.get_timestamp_us() * 1000, _depth_mm(depth), self._info.camera, color, seq)
            seq += 1

    def _color(self, frames: Any) -> ColorImage | None:
        if self._align is None:
            return None
        aligned = self._align.process(frames)
        color = aligned.as_frame_set().get_color_frame() if aligned is not None else None
        if color is None:
            return None
        data = np.frombuffer(color.get_data(), dtype=np.uint8)
        return data.reshape(color.get_height(), color.get_width(), 3).copy()


def find_device(ob: Any, serial: str) -> Any:
    """The camera of that serial number, or the first. Raises SourceError."""
    devices = ob.Context().query_devices()
    found = [devices.get_device_serial_number_by_index(i) for i in range(devices.get_count())]
    if not found:
        raise SourceError("no Orbbec camera found; plug it into a USB 3 port, or run 'teleop doctor'")
    if serial and serial not in found:
        raise SourceError(f"no Orbbec camera with serial number '{serial}'; found: {', '.join(found)}")
    return devices.get_device_by_index(found.index(serial) if serial else 0)


def _depth_mm(frame: Any) -> DepthImage:
    raw = np.frombuffer(frame.get_data(), dtype=np.uint16).reshape(frame.get_height(), frame.get_width())
    scale = float(frame.get_depth_scale())
    if scale == 1.0:
        return raw.copy()
    mm = np.rint(raw * scale)
    return np.where(mm <= 65535, mm, 0).astype(np.uint16)
