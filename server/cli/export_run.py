"""The work behind ``teleop export``: frames with their tracking rows, recorded or made now, into a table or a film."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config import TeleopConfig
from teleop.errors import RecordingError
from teleop.frames import DepthFrame
from teleop.pipeline import Pipeline
from teleop.recording import McapSource, topics
from teleop.recording.csv_table import csv_columns, csv_values
from teleop.recording.video import VideoWriter, overlay
from teleop.sources.base import Source
from teleop.track_row import track_row

Tracked = Iterator[tuple[DepthFrame, dict[str, Any]]]


def tracked(source: Source, config: TeleopConfig) -> Tracked:
    """Frames with their rows: the recorded ones where there are any, else tracked now, the operator engaged."""
    if isinstance(source, McapSource) and topics.TRACK in source.file.topics:
        numbers = {int(t): i for i, t in enumerate(source.file.topics[topics.TRACK].t_ns)}
        for frame in source.frames():
            if frame.t_ns in numbers:
                yield frame, source.row(topics.TRACK, numbers[frame.t_ns])
        return
    pipeline = Pipeline(BodyTracker(load_model(), config.body), config)
    pipeline.tracker.warm_up(source.info.camera)
    state = pipeline.initial_state(assume_engaged=True)
    for frame in source.frames():
        output, state = pipeline.step(frame, state)
        yield frame, track_row(output.track, output.intent, output.command)


def write_csv(path: Path, pairs: Tracked, on_frame: Callable[[DepthFrame], None]) -> int:
    """A table with a header line; returns the number of rows. Raises RecordingError when it cannot be written."""
    count = 0
    try:
        with path.open("w", encoding="utf-8", newline="") as file:
            table = csv.writer(file)
            table.writerow(csv_columns())
            for frame, row in pairs:
                table.writerow(csv_values(row))
                count += 1
                on_frame(frame)
    except OSError as error:
        raise RecordingError(f"cannot write {path}: {error.strerror or error}") from None
    return count


def write_video(path: Path, pairs: Tracked, rate_hz: float, on_frame: Callable[[DepthFrame], None]) -> int:
    """An MP4 with the skeleton over depth and colour beside it; returns the number of frames. Raises RecordingError."""
    count = 0
    video = VideoWriter(path, rate_hz)
    try:
        for frame, row in pairs:
            video.write(frame.t_ns, overlay(frame, row))
            count += 1
            on_frame(frame)
    finally:
        video.close()
    return count
