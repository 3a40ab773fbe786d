"""The recordings library: the bundled ones (read only) and the user's own, by name and never by path."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from server.errors import Refused
from teleop.errors import RecordingError

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,79}")
_CHUNK = 1 << 20


@dataclass(frozen=True, slots=True)
class Entry:
    """One recording. modified_s: Unix time."""

    id: str
    path: Path
    bundled: bool
    size_bytes: int
    modified_s: float


class Library:
    """Files ``<folder>/<id>.mcap``. Names are letters, digits, dash and underscore, so none leads out of the folder."""

    def __init__(self, own: Path, bundled: Path, max_bytes: int) -> None:
        self._own = own
        self._bundled = bundled
        self._max_bytes = max_bytes
        self._durations: dict[tuple[Path, float], float | None] = {}

    @property
    def folder(self) -> Path:
        """Where own recordings lie."""
        return self._own

    def entries(self) -> list[Entry]:
        """Bundled ones first, then the newest own."""
        own = sorted(self._scan(self._own, bundled=False), key=lambda e: -e.modified_s)
        return [*sorted(self._scan(self._bundled, bundled=True), key=lambda e: e.id), *own]

    def find(self, name: str) -> Entry:
        """The recording of that name. Raises Refused (404) with the names there are."""
        entries = self.entries()
        for entry in entries:
            if entry.id == name:
                return entry
        names = ", ".join(entry.id for entry in entries) or "none"
        raise Refused(404, f"no recording '{name[:80]}'; there are: {names}")

    def duration_s(self, entry: Entry) -> float | None:
        """Length of a recording [s], None when it cannot be read; remembered until the file changes."""
        from teleop.recording import McapSource

        key = (entry.path, entry.modified_s)
        if key not in self._durations:
            try:
                source = McapSource(entry.path)
            except RecordingError:
                self._durations[key] = None
            else:
                self._durations[key] = source.info.duration_s
                source.close()
        return self._durations[key]

    def delete(self, name: str) -> None:
        """Remove an own recording. Raises Refused: 404 unknown, 403 bundled."""
        entry = self.find(name)
        if entry.bundled:
            raise Refused(403, f"'{name}' came with the project and stays; only own recordings can be deleted")
        entry.path.unlink()

    def new_path(self, name: str) -> Path:
        """Where a new recording of that name goes. Raises Refused: 422 bad name, 409 taken."""
        if not _NAME.fullmatch(name):
            raise Refused(422, "a recording's name has 1 to 80 letters, digits, dashes or underscores (then .mcap)")
        if any(entry.id == name for entry in self.entries()):
            raise Refused(409, f"there is already a recording '{name}'; delete it or choose another name")
        self._own.mkdir(parents=True, exist_ok=True)
        return self._own / f"{name}.mcap"

    def store(self, filename: str, data: BinaryIO) -> Entry:
        """Take an uploaded file in; it appears under its name only when it is complete and opens as a recording.

        Raises Refused (409, 413, 422) and RecordingError.
        """
        from teleop.recording import McapSource

        path = self.new_path(filename.removesuffix(".mcap"))
        partial = path.with_suffix(".part")
        try:
            with partial.open("wb") as out:
                size = 0
                while chunk := data.read(_CHUNK):
                    size += len(chunk)
                    if size > self._max_bytes:
                        raise Refused(413, f"a recording may have at most {self._max_bytes // 1_000_000} MB")
                    out.write(chunk)
            try:
                McapSource(partial).close()
            except RecordingError as error:  # the sender knows the file by its own name, not by ours
                raise Refused(422, str(error).replace(str(partial), path.name)) from error
            partial.replace(path)
        finally:
            partial.unlink(missing_ok=True)
        return self.find(path.stem)

    @staticmethod
    def _scan(folder: Path, *, bundled: bool) -> Iterator[Entry]:
        if not folder.is_dir():
            return
        for path in folder.glob("*.mcap"):
            if _NAME.fullmatch(path.stem) and path.is_file():
                stat = path.stat()
                yield Entry(path.stem, path, bundled, stat.st_size, stat.st_mtime)
