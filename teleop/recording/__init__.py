"""Recordings: MCAP files that Foxglove and the ``mcap`` packages open, written and read here."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from teleop.recording.mcap_source import McapSource
    from teleop.recording.recorder import AsyncRecorder, RecorderStatus
    from teleop.recording.writer import McapWriter

__all__ = ["AsyncRecorder", "McapSource", "McapWriter", "RecorderStatus"]

_HOME = {"McapSource": "mcap_source", "AsyncRecorder": "recorder", "RecorderStatus": "recorder", "McapWriter": "writer"}


def __getattr__(name: str) -> Any:
    """Load what is asked for: who only reads needs no writer, whose library takes 10 MB."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
