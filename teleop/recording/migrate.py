"""Metadata of older recordings as today's: one step per version, each from one to the next.

1 -> 2: ``mirrored``, ``color`` and ``T_color_depth`` became parts of one ``camera``.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Final

from teleop.errors import RecordingError
from teleop.recording import topics


def migrated(metadata: Mapping[str, str]) -> dict[str, str]:
    """The metadata in the present format; ``format_version`` keeps telling what the file has.

    Files of other programs have none and stay as they are. Raises RecordingError: a newer or damaged version.
    """
    found = dict(metadata)
    text = found.get(topics.KEY_FORMAT)
    if text is None:
        return found
    if not (text.isascii() and text.isdigit()) or not 1 <= int(text) <= topics.FORMAT_VERSION:
        raise RecordingError(
            f"it has format version {text[:20]}, teleop reads up to {topics.FORMAT_VERSION}; install a newer one"
        )
    for version in range(int(text), topics.FORMAT_VERSION):
        found = _STEPS[version](found)
    return found


def _one_camera(metadata: dict[str, str]) -> dict[str, str]:
    """The intrinsics of the depth stay where they were, in /camera/depth/camera_info."""
    kept = {k: v for k, v in metadata.items() if k not in ("mirrored", "color", "T_color_depth")}
    try:
        camera = {
            "mirrored": metadata.get("mirrored") == "true",
            "color": json.loads(metadata.get("color", "null")),
            "T_color_depth": json.loads(metadata.get("T_color_depth", "null")),
        }
    except ValueError as error:
        raise RecordingError(f"its metadata 'color' or 'T_color_depth' is damaged: {error}") from None
    return kept | {topics.KEY_CAMERA: json.dumps(camera)}


_STEPS: Final[dict[int, Callable[[dict[str, str]], dict[str, str]]]] = {1: _one_camera}
