"""``teleop track`` over a folder of recordings: many at once, what is done already is left, what fails is told."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from server.cli.track_run import rows
from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config import TeleopConfig
from teleop.errors import TeleopError
from teleop.parallel import Outcome, Pool
from teleop.pipeline import Pipeline
from teleop.recording.archive import fingerprint, recordings_in
from teleop.recording.identity import identity
from teleop.sources import open_source

DONE = "tracked.json"
"""In the output folder: which recordings are done, as they were then, and with what."""


@dataclass(frozen=True, slots=True)
class TrackTask:
    """One recording; rows go to ``output``, which is there only when they are complete."""

    name: str
    recording: Path
    output: Path
    config: TeleopConfig


@dataclass(frozen=True, slots=True)
class Tracked:
    """What a recording came to. persons: frames with a person."""

    frames: int
    persons: int


@dataclass(frozen=True, slots=True)
class ArchiveSummary:
    """failed: one line for each recording that could not be tracked, in order of names."""

    tracked: int
    frames: int
    left: int
    failed: tuple[str, ...]
    output: Path

    def line(self) -> str:
        """One line for people and scripts."""
        return (
            f"{self.tracked} recordings tracked ({self.frames} frames), {self.left} done before, "
            f"{len(self.failed)} failed -> {self.output}"
        )


def track_one(task: TrackTask) -> Tracked:
    """Track one recording (in a worker). Raises TeleopError, and then leaves no rows."""
    frames = persons = 0
    part = task.output.with_name(f".{task.output.name}.part")
    try:
        with closing(open_source(str(task.recording))) as source:
            pipeline = _pipeline(task.config.model_dump_json())
            pipeline.tracker.warm_up(source.info.camera)
            task.output.parent.mkdir(parents=True, exist_ok=True)
            with part.open("w", encoding="utf-8") as file:
                for row in rows(source, pipeline, []):
                    file.write(json.dumps(row, allow_nan=False, separators=(",", ":")) + "\n")
                    frames += 1
                    persons += any(row["joints"].values())  # type: ignore[attr-defined]
        if frames == 0:
            raise TeleopError("it holds no frames")
        part.replace(task.output)
    except OSError as error:
        raise TeleopError(f"cannot write {task.output}: {error.strerror or error}") from None
    finally:
        part.unlink(missing_ok=True)
    return Tracked(frames, persons)


def track_archive(
    folder: Path, output: Path, config: TeleopConfig, pool: Pool, on_done: Callable[[int, int, int], None]
) -> ArchiveSummary:
    """Track every recording in ``folder`` into ``output``/NAME.jsonl, but those that are done already.

    on_done: called with the recordings finished and in all, and the frames so far. Raises TeleopError when the folders
    cannot be used; what is wrong with single recordings is in the summary.
    """
    recordings = recordings_in(folder)
    done = _DoneList(output, config)
    tasks = []
    for recording in recordings:
        name = recording.relative_to(folder).as_posix()
        task = TrackTask(name, recording.resolve(), (output / f"{name}.jsonl").resolve(), config)
        if not done.has(task):
            tasks.append(task)
    tasks.sort(key=lambda task: -fingerprint(task.recording)[0])  # the longest first: no core waits for it at the end
    left, frames, failed = len(recordings) - len(tasks), 0, []
    on_done(left, len(recordings), 0)
    for finished, outcome in enumerate(pool.run(track_one, tasks), start=1):
        if outcome.error is None:
            frames += outcome.value().frames
            done.add(outcome)
        else:
            failed.append(f"{outcome.task.name}: {_reason(outcome.error)}")
        on_done(left + finished, len(recordings), frames)
    return ArchiveSummary(len(tasks) - len(failed), frames, left, tuple(sorted(failed)), output)


class _DoneList:
    """Kept up to date after every recording, so that an interruption loses only what was being worked on."""

    def __init__(self, output: Path, config: TeleopConfig) -> None:
        self._path = output / DONE
        made_with = json.dumps([identity(load_model()), config.model_dump(mode="json")], sort_keys=True)
        self._made_with = hashlib.sha256(made_with.encode()).hexdigest()
        self._done: dict[str, Any] = {}
        try:
            output.mkdir(parents=True, exist_ok=True)
            if self._path.exists():
                self._done = dict(json.loads(self._path.read_text(encoding="utf-8")))
        except OSError as error:
            raise TeleopError(f"cannot write into {output}: {error.strerror}; choose another --output") from None
        except ValueError as error:
            raise TeleopError(f"{self._path} is damaged ({error}); remove it, and all is tracked anew") from None

    def has(self, task: TrackTask) -> bool:
        return task.output.is_file() and self._done.get(task.name) == self._entry(task)

    def add(self, outcome: Outcome[TrackTask, Tracked]) -> None:
        self._done[outcome.task.name] = self._entry(outcome.task)
        part = self._path.with_name(f".{DONE}.part")
        part.write_text(json.dumps(self._done, indent=1, sort_keys=True), encoding="utf-8")
        part.replace(self._path)

    def _entry(self, task: TrackTask) -> list[Any]:
        return [*fingerprint(task.recording), self._made_with]


@lru_cache(maxsize=1)
def _pipeline(config_json: str) -> Pipeline:
    """One per worker: model and compiled kernels serve all its recordings."""
    config = TeleopConfig.model_validate_json(config_json)
    return Pipeline(BodyTracker(load_model(), config.body), config)


def _reason(error: Exception) -> str:
    """One line; a bug says its type, too."""
    text = " ".join(str(error).split())
    return text if isinstance(error, TeleopError) else f"{type(error).__name__}: {text}"
