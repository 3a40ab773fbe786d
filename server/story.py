"""What happened in a recording, for the timeline that shows it: events and modes; and a picture of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np

from server.api.models import Story, StoryEvent, StoryMode
from server.engine.preview import color_picture, depth_picture
from server.settings import StreamConfig
from teleop.recording import McapSource, topics

_MOST_EVENTS = 1000
_LOOKS = 600
"""Times at which the mode is looked up: more than a timeline has pixels for are of no use."""


def read_story(path: Path) -> Story:
    """Read it from the recording. Raises RecordingError."""
    source = McapSource(path)
    try:
        start_ns = source.start_ns
        events = [_event(row, t_ns, start_ns) for t_ns, row in _rows(source, topics.EVENTS, _MOST_EVENTS)]
        modes: list[StoryMode] = []
        for t_ns, row in _rows(source, topics.TRACK, _LOOKS):
            mode = str(row.get("mode", ""))
            if not modes or modes[-1].mode != mode:
                modes.append(StoryMode(position_s=_position_s(t_ns, start_ns), mode=mode))
        return Story(duration_s=source.info.duration_s or 0.0, events=events, modes=modes)
    finally:
        source.close()


def read_picture(path: Path, config: StreamConfig) -> bytes:
    """A JPEG of the middle of the recording, colour where there is some. Raises RecordingError."""
    source = McapSource(path)
    try:
        frame = next(iter(source.frames((source.info.duration_s or 0.0) / 2)), None)
        if frame is None:
            picture = np.zeros((60, 80, 3), np.uint8)
        elif frame.color_rgb is not None:
            picture = color_picture(frame.color_rgb, config)
        else:
            picture = depth_picture(frame.depth_mm, config)
        return bytes(cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, config.jpeg_quality])[1])
    finally:
        source.close()


def _rows(source: McapSource, topic: str, most: int) -> list[tuple[int, dict[str, Any]]]:
    """Time and row of a topic's messages, evenly thinned out to ``most``."""
    if topic not in source.file.topics:
        return []
    times = source.file.topics[topic].t_ns
    step = max(1.0, len(times) / most)
    numbers = sorted({int(i * step) for i in range(min(most, len(times)))})
    return [(int(times[number]), source.row(topic, number)) for number in numbers]


def _event(row: dict[str, Any], t_ns: int, start_ns: int) -> StoryEvent:
    told = {key: str(row.get(key, "")) for key in ("kind", "reason", "detail")}
    return StoryEvent(position_s=_position_s(t_ns, start_ns), **told)


def _position_s(t_ns: int, start_ns: int) -> float:
    return round(max(0, t_ns - start_ns) * 1e-9, 2)
