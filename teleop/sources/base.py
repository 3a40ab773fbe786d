"""The one interface of all depth sources, live or recorded."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from teleop.frames import Camera, DepthFrame


@dataclass(frozen=True, slots=True)
class SourceInfo:
    """What is known of a source once it is open. frame_count and duration_s are None for live sources."""

    uri: str
    kind: str
    camera: Camera
    live: bool
    frame_count: int | None = None
    duration_s: float | None = None
    has_color: bool = False


class Source(Protocol):
    """A stream of frames in order of time. Not thread-safe: one reader."""

    @property
    def info(self) -> SourceInfo:
        """What is known of the source."""
        ...

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:
        """Frames in order, from ``from_s`` seconds after the first one (recorded sources; live ones ignore it).

        Raises SourceError or RecordingError when the source fails in the middle.
        """
        ...

    def close(self) -> None:
        """Release the device or file; safe to call twice."""
        ...
