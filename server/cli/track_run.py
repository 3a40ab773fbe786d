"""The work behind ``teleop track``: frames in, rows out, with a progress bar and a summary."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from server.settings import load_settings, with_operator
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


def load_config(path: Path | None, no_filter: bool, operator: str | None = None) -> TeleopConfig:
    """The settings' [teleop] tree, as the server reads it, with an operator's profile where one is named.

    Raises SettingsError with the first wrong value, ProfileError for an unknown operator.
    """
    settings = load_settings(path)
    config = (with_operator(settings, operator) if operator is not None else settings).teleop
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


def refuse_source_as_output(uri: str, output: Path) -> None:
    """Raises TeleopError when writing the output would destroy the source, or part of it."""
    source = Path(uri)
    if not source.exists():
        return
    if source.resolve() in (output.resolve(), *output.resolve().parents):
        raise TeleopError(f"{output} is the source itself or lies in it; choose another --output")


@contextmanager
def whole_rows(output: Path) -> Iterator[TextIO]:
    """A text file that takes its name once it holds rows: an older one is kept until then.

    Rows written before an interruption or a fault stay. Raises TeleopError when it cannot be written.
    """
    part = output.with_name(f".{output.name}.part")
    direct = output.exists() and not output.is_file()  # a pipe or a terminal cannot be renamed to
    try:
        # one write per line, so that an interrupted file ends with a whole row
        file = (output if direct else part).open("w", encoding="utf-8", buffering=1)
    except OSError as error:
        raise TeleopError(f"cannot write {output}: {error.strerror}; choose another --output") from error
    try:
        with file:
            yield file
    finally:
        if not direct and part.stat().st_size > 0:
            part.replace(output)
        elif not direct:
            part.unlink()


def run_track(uri: str, output: Path, config: TeleopConfig, console: Console) -> Summary:
    """Track a whole source into a JSON-lines file; rows written before an interruption stay.

    Raises TeleopError for a source, a model or an output that cannot be used.
    """
    if not output.parent.is_dir():
        raise TeleopError(f"cannot write {output}: its folder does not exist; choose another --output")
    if output.is_dir():
        raise TeleopError(f"cannot write {output}: it is a folder; name a file, such as {output / 'rows.jsonl'}")
    refuse_source_as_output(uri, output)
    with closing(open_source(uri)) as source:
        pipeline = Pipeline(BodyTracker(load_model(), config.body), config)
        with console.status("compiling kernels"):
            pipeline.tracker.warm_up(source.info.camera)
        times_ms: list[float] = []
        persons = 0
        columns = (TextColumn("tracking"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
        with whole_rows(output) as file, Progress(*columns, console=console, transient=True) as progress:
            bar = progress.add_task("tracking", total=source.info.frame_count)
            for row in rows(source, pipeline, times_ms):
                file.write(json.dumps(row, allow_nan=False, separators=(",", ":")) + "\n")
                persons += any(row["joints"].values())  # type: ignore[attr-defined]
                progress.advance(bar)
    if not times_ms:
        raise TeleopError(f"{uri} holds no frames; nothing to track")
    return Summary(len(times_ms), persons, tuple(times_ms), output)
