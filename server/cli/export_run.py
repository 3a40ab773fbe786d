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
from teleop.recording.convert import convert, refuse_overwrite
from teleop.recording.csv_table import csv_columns, csv_values
from teleop.recording.lerobot_features import Vectors
from teleop.recording.lerobot_writer import LeRobotWriter
from teleop.recording.recorded import RecordedRobot
from teleop.recording.resumable import remove
from teleop.recording.video import VideoWriter, overlay
from teleop.sources.base import Source
from teleop.track_row import track_row

_GAP_S = 1.0
"""A longer one between two frames begins another episode."""
_USUAL_HZ = 30

Tracked = Iterator[tuple[DepthFrame, dict[str, Any]]]
KINDS = (".csv", ".mp4", ".fakenect", ".lerobot")
TASK = "pick and spray in the greenhouse by gestures"
"""What is done, in words, for a LeRobot dataset."""


def export_to(
    output: Path,
    source: Source,
    config: TeleopConfig,
    on_frame: Callable[[DepthFrame], None],
    *,
    force: bool = False,
    rate_hz: float = 30.0,
    task: str = TASK,
) -> int:
    """Write a recorded source as what the output's name ends with (KINDS); returns the number of frames.

    The output appears only when it is complete. force: replace one that exists. rate_hz: of a film. Raises TeleopError.
    """
    if source.info.live:
        raise RecordingError(f"{source.info.uri} is live and has no end; record it first with 'teleop record'")
    kind = output.suffix.lower()
    if kind == ".fakenect":
        return convert(source, output, force=force, on_frame=on_frame)
    refuse_overwrite(output, source, force)
    partial = output.with_name(f"{output.stem}.partial{output.suffix}")
    pairs = tracked(source, config)
    try:
        if kind == ".csv":
            count = write_csv(partial, pairs, on_frame)
        elif kind == ".lerobot":
            remove(partial)
            count = write_lerobot(partial, source, pairs, task, on_frame)
        else:
            count = write_video(partial, pairs, rate_hz, on_frame)
        if count == 0:
            raise RecordingError(f"{source.info.uri} has no frames with tracking rows; nothing was written")
        if force or output.is_dir():
            remove(output)
        partial.replace(output)
    finally:
        remove(partial)
    return count


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


def write_lerobot(
    folder: Path, source: Source, pairs: Tracked, task: str, on_frame: Callable[[DepthFrame], None]
) -> int:
    """A LeRobot dataset with depth as it is; returns the number of frames. Raises RecordingError."""
    robot = RecordedRobot(source) if isinstance(source, McapSource) else None
    vectors: Vectors | None = None
    writer: LeRobotWriter | None = None
    last_ns = count = 0
    for frame, row in pairs:
        pose = robot.at(frame.t_ns) if robot else None
        if writer is None or vectors is None:
            vectors = Vectors(tuple(pose.joint_rad) if pose else ())
            writer = LeRobotWriter(folder, _rate_hz(source), task, vectors.names())
        elif frame.t_ns - last_ns > _GAP_S * 1e9:
            writer.end_episode()
        last_ns = frame.t_ns
        writer.write(frame, vectors.of(row, pose))
        count += 1
        on_frame(frame)
    if writer is not None:
        writer.close()
    return count


def _rate_hz(source: Source) -> int:
    """Whole frames a second, which is what a dataset can have."""
    count, duration_s = source.info.frame_count, source.info.duration_s
    if not count or not duration_s or count < 2:
        return _USUAL_HZ
    return max(1, round((count - 1) / duration_s))
