"""depth.txt and rgb.txt: lines ``seconds path`` in order of time, as the TUM RGB-D benchmark writes them."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from itertools import pairwise
from pathlib import Path

from teleop.errors import SourceError

_log = logging.getLogger(__name__)
_ASSUMED_PERIOD_NS = 33_333_333


@dataclass(frozen=True, slots=True)
class ImageFile:
    """One image and its time."""

    t_ns: int
    path: Path


def list_images(folder: Path, list_name: str, image_folder: str, suffixes: Sequence[str]) -> list[ImageFile]:
    """Images in order of time, after the list file, else after the sorted names in ``image_folder``.

    Without a list, names that are numbers of seconds are the times (TUM); others are taken as 30 frames/s.
    Raises SourceError: a bad line, two images at one time, listed files that are missing.
    """
    listing = folder / list_name
    images = _read_list(listing) if listing.is_file() else _from_names(folder / image_folder, suffixes)
    images.sort(key=lambda image: image.t_ns)
    for before, after in pairwise(images):
        if before.t_ns == after.t_ns:
            raise SourceError(f"{folder}: {before.path.name} and {after.path.name} have the same time")
    missing = [image.path for image in images if not image.path.is_file()]
    if missing:
        raise SourceError(f"{listing} lists {len(missing)} missing files, the first is {missing[0]}")
    return images


def seconds_text(t_ns: int) -> str:
    """Time as exact decimal seconds."""
    return f"{t_ns // 1_000_000_000}.{t_ns % 1_000_000_000:09d}"


def _read_list(listing: Path) -> list[ImageFile]:
    images = []
    try:
        lines = listing.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise SourceError(f"cannot read {listing}: {error}") from None
    for number, line in enumerate(lines, start=1):
        text = line.strip()
        if not text or text.startswith("#"):
            continue
        seconds, _, name = text.partition(" ")
        t_ns = _nanoseconds(seconds)
        if t_ns is None or not name.strip():
            raise SourceError(f"{listing}, line {number}: expected 'seconds path', got '{text[:60]}'")
        images.append(ImageFile(t_ns, listing.parent / name.strip()))
    return images


def _from_names(folder: Path, suffixes: Sequence[str]) -> list[ImageFile]:
    if not folder.is_dir():
        return []
    paths = sorted(p for p in folder.iterdir() if p.suffix.lower() in suffixes)
    times = [_nanoseconds(p.stem) if "." in p.stem else None for p in paths]
    if paths and None in times:
        _log.warning("%s: no list of times beside it; taking 30 frames/s in order of names", folder)
        return [ImageFile(i * _ASSUMED_PERIOD_NS, p) for i, p in enumerate(paths)]
    return [ImageFile(t, p) for t, p in zip(times, paths, strict=True) if t is not None]


def _nanoseconds(text: str) -> int | None:
    try:
        value = Decimal(text)
    except InvalidOperation:
        return None
    return round(value.scaleb(9)) if value.is_finite() and 0 <= value < 10**10 else None
