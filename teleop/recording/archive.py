"""A folder of recordings: what in it can be opened as a source, and whether one has changed since."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from teleop.errors import RecordingError

SUFFIXES = (".mcap", ".oni", ".bag", ".db3")
_FOLDER_MARKS = ("depth", "depth.txt", "camera.json", "INDEX.txt")


def is_archive(path: Path) -> bool:
    """Whether it is a folder, and not itself a recording (RGB-D folder or fakenect dump)."""
    return path.is_dir() and not _is_session(path)


def recordings_in(folder: Path) -> list[Path]:
    """Every recording in the folder and below, in order of names; hidden ones are left out.

    Raises RecordingError when there is none.
    """
    found = sorted(_walk(folder))
    if not found:
        raise RecordingError(
            f"{folder} holds no recordings; looked for {', '.join(f'*{s}' for s in SUFFIXES)}, RGB-D folders and "
            "fakenect dumps, there and below"
        )
    return found


def fingerprint(recording: Path) -> tuple[int, int]:
    """Size in bytes and time of the last change [ns]; of a folder the latest of its parts', its size as 0."""
    if not recording.is_dir():
        stat = recording.stat()
        return stat.st_size, stat.st_mtime_ns
    parts = (recording, *(recording / name for name in (*_FOLDER_MARKS, "rgb", "rgb.txt")))
    return 0, max(part.stat().st_mtime_ns for part in parts if part.exists())


def _walk(folder: Path) -> Iterator[Path]:
    for place, folders, files in os.walk(folder):
        here = Path(place)
        sessions = [name for name in folders if _is_session(here / name)]
        folders[:] = [name for name in folders if name not in sessions and not name.startswith(".")]
        yield from (here / name for name in sessions if not name.startswith("."))
        yield from (here / name for name in files if name.lower().endswith(SUFFIXES) and not name.startswith("."))


def _is_session(folder: Path) -> bool:
    return any((folder / name).exists() for name in _FOLDER_MARKS)
