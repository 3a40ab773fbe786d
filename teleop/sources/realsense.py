"""Intel RealSense devices and their .bag and .db3 recordings, through ``pyrealsense2``."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from teleop.errors import SourceError
from teleop.frames import Camera, DepthFrame, DepthImage, Intrinsics
from teleop.sources.base import SourceInfo
from teleop.sources.live import import_driver, increasing

_WAIT_MS = 500
_SILENCE_MS = 5000
_FILES = (".bag", ".db3")


class RealSenseSource:
    """One device or file; colour is aligned to depth, pixel by pixel."""

    def __init__(self, argument: str = "") -> None:
        """argument: a serial number, a .bag or .db3 file, or empty for the first device. Raises SourceError."""
        self._rs: Any = import_driver("pyrealsense2", "pyrealsense2")
        self._argument = argument
        self._is_file = argument.lower().endswith(_FILES)
        self._running = False
        if self._is_file and not Path(argument).is_file():
            raise SourceError(f"no file {argument}")
        if not self._is_file:
            self._require_device()
        self._align = self._rs.align(self._rs.stream.depth)
        self._start()
        self._info = self._describe()

    @property
    def info(self) -> SourceInfo:
        """What is known of the device or file."""
        return self._info

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:
        """Frames stamped by the device. Raises SourceError when a live device stops."""
        if self._is_file:
            self._stop()
            self._start()
        yield from increasing(self._read(from_s))

    def close(self) -> None:
        """Stop the pipeline; safe to call twice."""
        self._stop()

    def _start(self) -> None:
        rs = self._rs
        self._pipeline = rs.pipeline()
        config = rs.config()
        if self._is_file:
            rs.config.enable_device_from_file(config, self._argument, False)
        else:
            if self._argument:
                config.enable_device(self._argument)
            config.enable_stream(rs.stream.depth, 640, 480, rs.format.z16, 30)
            config.enable_stream(rs.stream.color, 640, 480, rs.format.rgb8, 30)
        try:
            if self._is_file:
                # Before the start: afterwards the first frames would already be skipped.
                profile = config.resolve(rs.pipeline_wrapper(self._pipeline))
                profile.get_device().as_playback().set_real_time(False)
            self._profile = self._pipeline.start(config)
        except RuntimeError as error:
            raise SourceError(f"realsense:{self._argument} cannot be opened: {error}") from None
        self._running = True

    def _stop(self) -> None:
        if self._running:
            self._running = False
            self._pipeline.stop()

    def _require_device(self) -> None:
        found = [d.get_info(self._rs.camera_info.serial_number) for d in self._rs.context().query_devices()]
        if not found:
            raise SourceError("no RealSense camera found; plug it into a USB 3 port, or run 'teleop doctor'")
        if self._argument and self._argument not in found:
            raise SourceError(f"no RealSense camera with serial number '{self._argument}'; found: {', '.join(found)}")

    def _describe(self) -> SourceInfo:
        streams = {s.stream_type(): s for s in self._profile.get_streams()}
        depth = streams.get(self._rs.stream.depth)
        if depth is None:
            self._stop()
            raise SourceError(f"realsense:{self._argument} has no depth stream")
        k = depth.as_video_stream_profile().get_intrinsics()
        units_m = self._depth_units_m()
        self._mm_per_unit = 1000.0 * units_m
        duration_s = None
        if self._is_file:
            duration_s = self._profile.get_device().as_playback().get_duration().total_seconds()
        return SourceInfo(
            uri=f"realsense:{self._argument}",
            kind="realsense",
            camera=Camera(Intrinsics(k.fx, k.fy, k.ppx, k.ppy, k.width, k.height)),
            live=not self._is_file,
            duration_s=duration_s,
            has_color=self._rs.stream.color in streams,
        )

    def _depth_units_m(self) -> float:
        rs = self._rs
        for sensor in self._profile.get_device().query_sensors():
            if sensor.supports(rs.option.depth_units):
                return float(sensor.get_option(rs.option.depth_units))
        return 0.001

    def _read(self, from_s: float) -> Iterator[DepthFrame]:
        first_ms: float | None = None
        for seq, frames in enumerate(_best_pairs(self._sets()) if self._is_file else self._sets()):
            depth = frames.get_depth_frame()
            t_ms = depth.get_timestamp()
            first_ms = t_ms if first_ms is None else first_ms
            if self._info.live or t_ms - first_ms >= from_s * 1e3:
                color = self._align.process(frames).get_color_frame() if frames.get_color_frame() else None
                rgb = np.asanyarray(color.get_data()).copy() if color else None
                yield DepthFrame(round(t_ms * 1e6), self._depth_mm(depth), self._info.camera, rgb, seq)

    def _sets(self) -> Iterator[Any]:
        """Sets of frames with depth in them, until the file ends or ``close``."""
        silent_ms = 0
        while self._running:
            ok, frames = self._pipeline.try_wait_for_frames(_WAIT_MS)
            if ok:
                silent_ms = 0
                if frames.get_depth_frame():
                    yield frames
                continue
            if self._is_file and self._at_end():
                return
            silent_ms += _WAIT_MS
            if silent_ms >= _SILENCE_MS:
                raise SourceError(f"{self._info.uri}: no frames for {_SILENCE_MS / 1000:.0f} s; check the cable")

    def _at_end(self) -> bool:
        status = self._profile.get_device().as_playback().current_status()
        return bool(status == self._rs.playback_status.stopped)

    def _depth_mm(self, frame: Any) -> DepthImage:
        raw = np.asanyarray(frame.get_data())
        if abs(self._mm_per_unit - 1.0) < 1e-6:
            return raw.astype(np.uint16)
        mm = np.rint(raw * self._mm_per_unit)
        return np.where(mm <= 65535, mm, 0).astype(np.uint16)


def _best_pairs(sets: Iterator[Any]) -> Iterator[Any]:
    """Of several sets with the same depth image, as a played file gives them, the one with the nearest colour."""
    held: Any = None
    for frames in sets:
        if held is not None and frames.get_depth_frame().get_timestamp() != held.get_depth_frame().get_timestamp():
            yield held
            held = frames
        elif held is None or _color_lag_ms(frames) < _color_lag_ms(held):
            held = frames
    if held is not None:
        yield held


def _color_lag_ms(frames: Any) -> float:
    color = frames.get_color_frame()
    return abs(color.get_timestamp() - frames.get_depth_frame().get_timestamp()) if color else float("inf")
