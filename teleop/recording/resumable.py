"""Going on with an output that an interruption left half done: only if it was made from the same by the same."""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from teleop.recording.archive import fingerprint
from teleop.software import software_version, sources_digest

_MARK: Final = ".resume.json"


def prepare(partial: Path, source_uri: str, options: dict[str, Any]) -> None:
    """Leave the folder as it is when what it holds can be gone on with, else make it anew. Raises OSError."""
    mark = {"of": _key(source_uri, options)}
    if _mark_of(partial) == mark:
        return
    remove(partial)
    partial.mkdir()
    (partial / _MARK).write_text(json.dumps(mark), encoding="utf-8")


def finish(partial: Path) -> None:
    """The output is complete: take the mark off, if it has one."""
    if partial.is_dir():
        (partial / _MARK).unlink(missing_ok=True)


def remove(path: Path) -> None:
    """Remove a file or a folder that was written here, if it is there."""
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def keep_lines(path: Path, wanted: Callable[[str], bool], counts: Callable[[str], bool] = lambda _: True) -> int:
    """Cut a list of files back to the whole lines before the first unwanted one, the last of which counts.

    Returns how many of them count; 0 when there is no list yet.
    """
    if not path.exists():
        return 0
    kept: list[str] = []
    count = end = 0
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines(keepends=True):
        if not line.endswith("\n") or not wanted(line):
            break
        kept.append(line)
        if counts(line):
            count, end = count + 1, len(kept)
    path.write_text("".join(kept[:end]), encoding="utf-8")
    return count


def _mark_of(partial: Path) -> Any:
    try:
        return json.loads((partial / _MARK).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None  # none there, or none that can be read


def _key(source_uri: str, options: dict[str, Any]) -> str:
    path = Path(source_uri)
    source = [str(path.resolve()), *fingerprint(path)] if path.exists() else [source_uri]
    made_by = [software_version(), sources_digest("teleop.recording", "teleop.sources")]
    return hashlib.sha256(json.dumps([source, options, made_by], sort_keys=True).encode()).hexdigest()
