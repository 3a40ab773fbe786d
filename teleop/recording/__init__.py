"""Recordings: MCAP files that Foxglove and the ``mcap`` packages open, written and read here."""

from teleop.recording.mcap_source import McapSource
from teleop.recording.recorder import AsyncRecorder, RecorderStatus
from teleop.recording.writer import McapWriter

__all__ = ["AsyncRecorder", "McapSource", "McapWriter", "RecorderStatus"]
