"""OpenNI2 devices (Kinect v1, Xtion, Astra) and .oni files, through the ``openni`` package and libOpenNI2."""

from __future__ import annotations

import ctypes.util
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from teleop.errors import SourceError
from teleop.frames import Camera, ColorImage, DepthFrame, DepthImage, Intrinsics
from teleop.sources.base import SourceInfo
from teleop.sources.freenect import UNREGISTERED
from teleop.sources.live import import_driver, increasing
from teleop.sources.registration import Registration

_TIMEOUT_S = 2.0
_LIBRARY_HINT = "'sudo apt install libopenni2-0' on Debian and Ubuntu, or run 'teleop doctor'"


class OpenNI2Source:
    """One OpenNI2 device or .oni file; depth in millimetres, colour registered to it by the device, else by us."""

    def __init__(self, argument: str = "") -> None:
        """argument: a device URI, an .oni file, or empty for the first device. Raises SourceError."""
        self._api: Any = start_openni2()
        self._closed = False
        self._at_start = True
        self._registration: Registration | None = None
        is_file = argument.lower().endswith(".oni")
        if is_file and not Path(argument).is_file():
            raise SourceError(f"no file {argument}")
        if not is_file:
            _require_device(self._api, argument)
        try:
            self._argument = argument
            self._open_streams(is_file)
            self._info = self._describe(f"openni2:{argument}", is_file)
        except self._api.OpenNIError as error:
            hint = "the file is cut off or no .oni recording" if is_file else "run 'teleop doctor'"
            raise SourceError(
                f"OpenNI2 cannot open '{argument or 'the first device'}': {_line(error)}; {hint}"
            ) from None

    @property
    def info(self) -> SourceInfo:
        """What is known of the device or file."""
        return self._info

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:
        """Frames stamped by the device. Raises SourceError when none comes for two seconds."""
        try:
            if not (self._info.live or self._at_start):
                # Opened anew: libOpenNI2 2.2 may never return from a seek.
                self._close_streams()
                self._open_streams(is_file=True)
            self._at_start = False
            yield from increasing(self._read(from_s))
        except self._api.OpenNIError as error:
            raise SourceError(f"{self._info.uri}: {_line(error)}") from None

    def close(self) -> None:
        """Stop the streams; safe to call twice."""
        if not self._closed:
            self._closed = True
            self._close_streams()

    def _close_streams(self) -> None:
        for stream in (self._depth, self._color):
            if stream is not None:
                stream.close()
        self._device.close()

    def _open_streams(self, is_file: bool) -> None:
        api = self._api
        self._at_start = True
        self._registers = True  # a file's colour is as it was recorded
        self._device = api.Device(self._argument.encode() if self._argument else None)
        self._depth = self._device.create_depth_stream()
        if self._depth is None:
            raise SourceError("the OpenNI2 device has no depth sensor; choose another")
        self._color = self._device.create_color_stream()
        if is_file:
            self._device.playback.set_repeat_enabled(False)
            self._device.playback.set_speed(-1.0)  # as fast as it is read
        else:
            self._depth.configure_mode(640, 480, 30, api.PIXEL_FORMAT_DEPTH_1_MM)
            if self._color is not None:
                self._color.configure_mode(640, 480, 30, api.PIXEL_FORMAT_RGB888)
            registration = api.IMAGE_REGISTRATION_DEPTH_TO_COLOR
            self._registers = self._color is not None and self._device.is_image_registration_mode_supported(
                registration
            )
            if self._registers:
                self._device.set_image_registration_mode(registration)
            for stream in (self._depth, self._color):
                if stream is not None:
                    stream.set_mirroring_enabled(False)
        self._depth.start()
        if self._color is not None:
            self._color.start()

    def _describe(self, uri: str, is_file: bool) -> SourceInfo:
        mode = self._depth.get_video_mode()
        width, height = int(mode.resolutionX), int(mode.resolutionY)
        k = _intrinsics(self._depth, width, height)
        camera = Camera(k, mirrored=self._depth.get_mirroring_enabled())
        if self._color is not None and not self._registers:
            # the library tells no distance between the cameras: PrimeSense's nominal one
            own = _intrinsics(self._color, 640, 480)
            self._registration = Registration(Camera(k, camera.mirrored, own, UNREGISTERED.T_color_depth))
        self._tenths = mode.pixelFormat == self._api.PIXEL_FORMAT_DEPTH_100_UM
        count = self._depth.get_number_of_frames() if is_file else None
        return SourceInfo(
            uri=uri,
            kind="openni2",
            camera=camera,
            live=not is_file,
            frame_count=count,
            duration_s=count / mode.fps if count and mode.fps else None,
            has_color=self._color is not None,
        )

    def _read(self, from_s: float) -> Iterator[DepthFrame]:
        seq = 0
        first_us: int | None = None
        limit = self._info.frame_count
        while not self._closed and (limit is None or seq < limit):
            if self._api.wait_for_any_stream([self._depth], _TIMEOUT_S) is None:
                raise SourceError(f"{self._info.uri}: no depth for {_TIMEOUT_S:.0f} s; check the cable")
            frame = self._depth.read_frame()
            first_us = frame.timestamp if first_us is None else first_us
            color = self._newest_color()
            if self._info.live or frame.timestamp - first_us >= from_s * 1e6:
                depth_mm = self._depth_mm(frame)
                if self._registration is not None and color is not None:
                    color = self._registration(depth_mm, color)
                yield DepthFrame(frame.timestamp * 1000, depth_mm, self._info.camera, color, seq)
            seq += 1

    def _depth_mm(self, frame: Any) -> DepthImage:
        raw = _pixels(frame, np.uint16).reshape(frame.height, frame.width)
        return (raw // 10).astype(np.uint16) if self._tenths else raw

    def _newest_color(self) -> ColorImage | None:
        if self._color is None or self._api.wait_for_any_stream([self._color], _TIMEOUT_S) is None:
            return None
        frame = self._color.read_frame()
        if frame.videoMode.pixelFormat != self._api.PIXEL_FORMAT_RGB888:
            return None
        return _pixels(frame, np.uint8).reshape(frame.height, frame.width, 3)


def start_openni2() -> Any:
    """The ``openni.openni2`` module, initialised. Raises SourceError when package or library is missing."""
    api: Any = import_driver("openni.openni2", "openni")
    if api.is_initialized():
        return api
    name = ctypes.util.find_library("OpenNI2")
    if name is None:
        raise SourceError(f"libOpenNI2 is not installed; {_LIBRARY_HINT}")
    try:
        if api.loaded_dll_directory is None:
            # The package looks for libOpenNI2.so only; Debian's file is libOpenNI2.so.0.
            import_driver("openni._openni2", "openni").load_dll(name)
            api.loaded_dll_directory = name
        api.initialize()
    except (OSError, api.OpenNIError) as error:
        raise SourceError(f"libOpenNI2 does not start: {_line(error)}; {_LIBRARY_HINT}") from None
    return api


def device_uris(api: Any) -> list[str]:
    """URIs of the connected devices."""
    return [uri.decode(errors="replace") for uri in api.Device.enumerate_uris()]


def _require_device(api: Any, uri: str) -> None:
    found = device_uris(api)
    if not found:
        raise SourceError("no OpenNI2 device found; check its cable and power supply, or run 'teleop doctor'")
    if uri and uri not in found:
        raise SourceError(f"no OpenNI2 device '{uri}'; found: {', '.join(found)}")


def _pixels(frame: Any, kind: type[Any]) -> npt.NDArray[Any]:
    data = ctypes.string_at(frame.data, frame.dataSize)
    return np.frombuffer(data, dtype=kind)


def _intrinsics(stream: Any, width: int, height: int) -> Intrinsics:
    """From a stream's field of view."""
    return Intrinsics(
        width / 2 / math.tan(stream.get_horizontal_fov() / 2),
        height / 2 / math.tan(stream.get_vertical_fov() / 2),
        (width - 1) / 2,
        (height - 1) / 2,
        width,
        height,
    )


def _line(error: Exception) -> str:
    return " ".join(str(error).split())
