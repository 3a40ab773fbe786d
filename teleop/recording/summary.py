"""What a source holds, read once from end to end: the answer of ``teleop info``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from teleop.frames import Camera, DepthFrame
from teleop.recording.mcap_source import McapSource
from teleop.sources.base import Source

GAP_FACTOR = 1.8
"""Two frames lie a gap apart when their distance in time exceeds this many median periods."""


@dataclass(frozen=True, slots=True)
class TopicSummary:
    """Messages of one topic of a recording."""

    schema: str
    messages: int


@dataclass(frozen=True, slots=True)
class SourceSummary:
    """All that is told about a source. Times in seconds, depth in millimetres."""

    uri: str
    kind: str
    live: bool
    camera: Camera
    frames: int
    duration_s: float
    rate_hz: float | None
    gaps: int
    longest_gap_s: float
    color_frames: int
    depth_min_mm: int | None
    depth_median_mm: int | None
    depth_max_mm: int | None
    valid_fraction: float
    size_bytes: int | None = None
    topics: Mapping[str, TopicSummary] = field(default_factory=dict)
    metadata: Mapping[str, str] = field(default_factory=dict)
    truncated: str | None = None


def summarise(
    source: Source, *, seconds: float | None = None, on_frame: Callable[[DepthFrame], None] | None = None
) -> SourceSummary:
    """Read the source (``seconds`` of it when given) and say what it holds. Raises TeleopError."""
    t_ns: list[int] = []
    color_frames = pixels = 0
    histogram = np.zeros(65536, dtype=np.int64)
    for frame in source.frames():
        if seconds is not None and t_ns and frame.t_ns - t_ns[0] > seconds * 1e9:
            break
        t_ns.append(frame.t_ns)
        color_frames += frame.color_rgb is not None
        pixels += frame.depth_mm.size
        histogram += np.bincount(frame.depth_mm.ravel(), minlength=65536)
        if on_frame is not None:
            on_frame(frame)
    steps_s = np.diff(np.array(t_ns, dtype=np.int64)).astype(np.float64) * 1e-9
    period_s = float(np.median(steps_s)) if len(steps_s) else 0.0
    histogram[0] = 0
    read = int(histogram.sum())
    seen = np.flatnonzero(histogram)
    info = source.info
    recording = source if isinstance(source, McapSource) else None
    path = Path(info.uri)
    return SourceSummary(
        uri=info.uri,
        kind=info.kind,
        live=info.live,
        camera=info.camera,
        frames=len(t_ns),
        duration_s=(t_ns[-1] - t_ns[0]) * 1e-9 if t_ns else 0.0,
        rate_hz=1.0 / period_s if period_s > 0 else None,
        gaps=int(np.count_nonzero(steps_s > GAP_FACTOR * period_s)),
        longest_gap_s=float(steps_s.max()) if len(steps_s) else 0.0,
        color_frames=color_frames,
        depth_min_mm=int(seen[0]) if read else None,
        depth_median_mm=int(np.searchsorted(np.cumsum(histogram), read / 2)) if read else None,
        depth_max_mm=int(seen[-1]) if read else None,
        valid_fraction=read / pixels if pixels else 0.0,
        size_bytes=_size_bytes(path),
        topics={
            name: TopicSummary(recording.file.schema_name(name), len(index.t_ns))
            for name, index in sorted(recording.file.topics.items())
        }
        if recording
        else {},
        metadata=recording.metadata if recording else {},
        truncated=recording.truncated if recording else None,
    )


def _size_bytes(path: Path) -> int | None:
    if path.is_file():
        return path.stat().st_size
    if path.is_dir():
        return sum(p.stat().st_size for p in path.rglob("*") if p.is_file())
    return None
