"""From a source URI to an open source. Drivers are imported only when their kind is asked for."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Final

from teleop.errors import SourceError
from teleop.sources.base import Source

LEGAL_URIS: Final = (
    "a path to an .mcap recording, a path to an RGB-D folder, openni2:[uri or .oni], freenect:[index], "
    "realsense:[serial, .bag or .db3], orbbec:[serial], push:, virtual:"
)
_SCHEME = re.compile(r"^([A-Za-z][A-Za-z0-9+_-]+):(.*)$", re.DOTALL)
_DRIVER_OF_SUFFIX = {".oni": "openni2", ".bag": "realsense", ".db3": "realsense"}


def open_source(uri: str) -> Source:
    """Open any depth source. Raises SourceError or RecordingError, one line with the next step."""
    match = _SCHEME.match(uri)
    path = Path(uri).expanduser()
    if match is not None and not path.exists():
        opener = _OPENERS.get(match[1].lower())
        if opener is None:
            raise SourceError(f"unknown kind of source '{match[1]}:'; legal are {LEGAL_URIS}")
        return opener(match[2])
    return _open_path(uri, path)


def _open_path(uri: str, path: Path) -> Source:
    if not uri.strip():
        raise SourceError(f"no source given; legal are {LEGAL_URIS}")
    if (path / "INDEX.txt").is_file():
        from teleop.sources.fakenect_dump import FakenectDumpSource

        return FakenectDumpSource(path)
    if path.is_dir():
        from teleop.sources.rgbd_folder import RgbdFolderSource

        return RgbdFolderSource(path)
    driver = _DRIVER_OF_SUFFIX.get(path.suffix.lower())
    if driver is not None:
        return _OPENERS[driver](str(path))
    if not path.exists() and path.suffix.lower() != ".mcap":
        raise SourceError(f"no file or folder '{uri}'; legal are {LEGAL_URIS}")
    from teleop.recording.mcap_source import McapSource

    return McapSource(path)


def _driver(kind: str) -> Callable[[str], Source]:
    """A sensor's library lives in a process of its own."""

    def open_driver(argument: str) -> Source:
        from teleop.sources.driver_process import DriverProcess

        return DriverProcess(kind, argument)

    return open_driver


def _push(argument: str) -> Source:
    raise SourceError(
        f"push:{argument} is fed over the server's websocket and opened only there; run 'teleop serve --source push:'"
    )


def _virtual(argument: str) -> Source:
    from teleop.sources.virtual import open_virtual

    return open_virtual(argument)


_OPENERS: Final[dict[str, Callable[[str], Source]]] = {
    "openni2": _driver("openni2"),
    "freenect": _driver("freenect"),
    "realsense": _driver("realsense"),
    "orbbec": _driver("orbbec"),
    "push": _push,
    "virtual": _virtual,
}
