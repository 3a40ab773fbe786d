"""The work behind ``teleop track``: frames in, rows out, with a progress bar and a summary."""

from __future__ import annotations

import json
import time
import tomllib
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import numpy as np
from pydantic import ValidationError
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config import TeleopConfig
from teleop.errors import TeleopError
from teleop.pipeline import Pipeline
from teleop.sources import open_source
from teleop.sources.base import Source
from teleop.track_row import track_row


@dataclass(frozen=True, slots=True)
class Summary:
    """What a run came to. frame_ms: processing time of each frame."""

    frames: int
    persons: int
    frame_ms: tuple[float, ...]
    output: Path

    def line(self) -> str:
        """One line for people and scripts."""
        if not self.frame_ms:
            return f"0 frames -> {self.output}"
        p50, p99 = np.percentile(self.frame_ms, [50, 99])
        fps = 1000.0 * len(self.frame_ms) / sum(self.frame_ms)
        return (
            f"{self.frames} frames, person in {self.persons}, "
            f"{p50:.1f} ms/frame p50, {p99:.1f} ms p99, {fps:.1f} frames/s -> {self.output}"
        )


def load_config(path: Path | None, no_filter: bool) -> TeleopConfig:
    """The configuration tree from a TOML file, or the defaults. Raises TeleopError with the first wrong value."""
    try:
        tree = {} if path is None else tomllib.loads(path.read_text(encoding="utf-8"))
        config = TeleopConfig.model_validate(tree)
    except OSError as error:
        raise TeleopError(f"configuration {path}: {error.strerror}; give an existing TOML file") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise TeleopError(f"configuration {path} is not TOML: {error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise TeleopError(f"configuration {path}: {where}: {first['msg']} (got {first['input']!r})") from error
    if not no_filter:
        return config
    unfiltered = config.body.filter.model_copy(update={"enabled": False})
    return config.model_copy(update={"body": config.body.model_copy(update={"filter": unfiltered})})


def rows(source: Source, pipeline: Pipeline, times_ms: list[float]) -> Iterator[dict[str, object]]:
    """One row per frame, in order; the operator is taken as engaged. Appends each frame's time to ``times_ms``."""
    state = pipeline.initial_state(assume_engaged=True)
    for frame in source.frames():
        start = time.perf_counter()
        out, state = pipeline.step(frame, state)
        row = track_row(out.track, out.intent, out.command)
        times_ms.append((time.perf_counter() - start) * 1e3)
        yield row


def _write(file: TextIO, row: dict[str, object]) -> None:
    # one write per line, so that an interrupted file ends with a whole row
    file.write(json.dumps(row, allow_nan=False, separators=(",", ":")) + "\n")


def run_track(uri: str, output: Path, config: TeleopConfig, console: Console) -> Summary:
    """Track a whole source into a JSON-lines file; rows written before an interruption stay.

    Raises TeleopError for a source, a model or an output that cannot be used.
    """
    if not output.parent.is_dir():
        raise TeleopError(f"cannot write {output}: its folder does not exist; choose another --output")
    with closing(open_source(uri)) as source:
        pipeline = Pipeline(BodyTracker(load_model(), config.body), config)
        with console.status("compiling kernels"):
            pipeline.tracker.warm_up(source.info.camera)
        times_ms: list[float] = []
        persons = 0
        columns = (TextColumn("tracking"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
        try:
            file = output.open("w", encoding="utf-8", buffering=1)
        except OSError as error:
            raise TeleopError(f"cannot write {output}: {error.strerror}; choose another --output") from error
        with file, Progress(*columns, console=console, transient=True) as progress:
            bar = progress.add_task("tracking", total=source.info.frame_count)
            for row in rows(source, pipeline, times_ms):
                _write(file, row)
                persons += any(row["joints"].values())  # type: ignore[attr-defined]
                progress.advance(bar)
    if not times_ms:
        raise TeleopError(f"{uri} holds no frames; nothing to track")
    return Summary(len(times_ms), persons, tuple(times_ms), output)
