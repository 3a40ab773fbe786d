"""The few calls of libfreenect's C API that a depth source needs, through ctypes (libfreenect.h, version 0.5)."""

from __future__ import annotations

import ctypes
from typing import Any, Final

from teleop.errors import SourceError

LIBRARY: Final = "libfreenect.so.0.5"
RESOLUTION_MEDIUM: Final = 1
VIDEO_RGB: Final = 0
DEPTH_11BIT: Final = 0
DEPTH_REGISTERED: Final = 4
_LOG_FATAL: Final = 0
_DEVICE_CAMERA: Final = 2

IMAGE_CALLBACK = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_uint32)
"""(device, image, time stamp in ticks)."""


class FrameMode(ctypes.Structure):
    """freenect_frame_mode."""

    _fields_ = (
        ("reserved", ctypes.c_uint32),
        ("resolution", ctypes.c_int32),
        ("format", ctypes.c_int32),
        ("bytes", ctypes.c_int32),
        ("width", ctypes.c_int16),
        ("height", ctypes.c_int16),
        ("data_bits_per_pixel", ctypes.c_int8),
        ("padding_bits_per_pixel", ctypes.c_int8),
        ("framerate", ctypes.c_int8),
        ("is_valid", ctypes.c_int8),
    )


class TimeVal(ctypes.Structure):
    """struct timeval."""

    _fields_ = (("tv_sec", ctypes.c_long), ("tv_usec", ctypes.c_long))


def load() -> Any:
    """The library with its signatures. Raises SourceError when it is not installed."""
    try:
        library: Any = ctypes.CDLL(LIBRARY)
    except OSError:
        raise SourceError(
            f"{LIBRARY} is not installed; 'sudo apt install libfreenect0.5' on Debian and Ubuntu, "
            "or run 'teleop doctor'"
        ) from None
    handle = ctypes.c_void_p
    for name, arguments in {
        "init": (ctypes.POINTER(handle), handle),
        "shutdown": (handle,),
        "set_log_level": (handle, ctypes.c_int),
        "select_subdevices": (handle, ctypes.c_int),
        "num_devices": (handle,),
        "open_device": (handle, ctypes.POINTER(handle), ctypes.c_int),
        "close_device": (handle,),
        "set_depth_callback": (handle, IMAGE_CALLBACK),
        "set_video_callback": (handle, IMAGE_CALLBACK),
        "set_depth_mode": (handle, FrameMode),
        "set_video_mode": (handle, FrameMode),
        "start_depth": (handle,),
        "start_video": (handle,),
        "stop_depth": (handle,),
        "stop_video": (handle,),
        "process_events_timeout": (handle, ctypes.POINTER(TimeVal)),
        "get_depth_mode_count": (),
        "get_depth_mode": (ctypes.c_int,),
        "get_video_mode_count": (),
        "get_video_mode": (ctypes.c_int,),
    }.items():
        getattr(library, f"freenect_{name}").argtypes = arguments
    library.freenect_get_depth_mode.restype = FrameMode
    library.freenect_get_video_mode.restype = FrameMode
    return library


def open_context(library: Any) -> ctypes.c_void_p:
    """A quiet context for cameras only. Raises SourceError when the USB bus cannot be reached."""
    context = ctypes.c_void_p()
    if library.freenect_init(ctypes.byref(context), None) < 0:
        raise SourceError("libfreenect cannot open the USB bus; run 'teleop doctor'")
    library.freenect_set_log_level(context, _LOG_FATAL)
    library.freenect_select_subdevices(context, _DEVICE_CAMERA)
    return context


def device_count() -> int:
    """Number of Kinects. Raises SourceError when the library is missing or cannot reach the USB bus."""
    library = load()
    context = open_context(library)
    try:
        return int(library.freenect_num_devices(context))
    finally:
        library.freenect_shutdown(context)


def depth_modes(library: Any) -> dict[int, FrameMode]:
    """640x480 depth modes by format."""
    return _modes(library.freenect_get_depth_mode_count, library.freenect_get_depth_mode)


def video_modes(library: Any) -> dict[int, FrameMode]:
    """640x480 video modes by format."""
    return _modes(library.freenect_get_video_mode_count, library.freenect_get_video_mode)


def _modes(count: Any, get: Any) -> dict[int, FrameMode]:
    modes = [get(i) for i in range(count())]
    return {m.format: m for m in modes if m.is_valid and m.resolution == RESOLUTION_MEDIUM and m.height == 480}
