"""From what a user or a client names to an open session: clients name recordings and sensors, never paths."""

from __future__ import annotations

import re
import time
from pathlib import Path

from server.engine.engine import Engine
from server.engine.session import Session
from server.errors import Refused
from server.library import Library
from teleop.sources import open_source
from teleop.sources.reconnect import open_lasting

LIVE_SCHEMES = ("openni2:", "freenect:", "realsense:", "orbbec:", "virtual:")
_FILE = re.compile(r"\.[A-Za-z]\w{1,4}$")
"""How the sensors' own recordings end (.oni, .bag, .db3): a driver would look for them in the server's folder."""


def open_named(engine: Engine, library: Library, name: str, *, loop: bool, record: bool = False) -> Session:
    """Open what a client asks for. Raises Refused (403 a path, 404 an unknown recording) and TeleopError."""
    scheme = next((s for s in LIVE_SCHEMES if name.lower().startswith(s)), None)
    if name.lower().startswith("push:"):
        raise Refused(422, "push: begins when a sender connects to /api/v1/push; close the running session for it")
    record_to = _record_to(library, name) if record else None
    if scheme is None:
        if ":" in name:
            legal = ", ".join((*LIVE_SCHEMES, "push:"))
            raise Refused(422, f"'{name[:80]}' is no source; legal: the name of a recording, or one of {legal}")
        return engine.open(name, open_source(str(library.find(name).path)), loop, record_to)
    if "/" in name or "\\" in name or ".." in name or _FILE.search(name):
        raise Refused(403, "files of this computer are opened on its command line only; upload a recording instead")
    if engine.session is not None and engine.session.info.live:
        engine.close_session(engine.session.id)  # a sensor can be opened once
    return engine.open(name, open_lasting(name, engine.settings.sensor.retry_s), loop, record_to)


def open_path(engine: Engine, library: Library, uri: str, *, loop: bool, record: bool = False) -> Session:
    """Open what the command line names: any path or URI, or a recording of the library. A recording goes by its bare
    name."""
    uri = located(library, uri)
    name = Path(uri).stem if uri.endswith(".mcap") else uri
    source = open_lasting(uri, engine.settings.sensor.retry_s)
    return engine.open(name, source, loop, _record_to(library, name) if record else None)


def located(library: Library, uri: str) -> str:
    """The path of a recording that is named as in the library; everything else is a path or URI already."""
    if ":" not in uri and not Path(uri).exists():
        for entry in library.entries():
            if entry.id == uri:
                return str(entry.path)
    return uri


def _record_to(library: Library, name: str) -> Path:
    """A new file of the library: when, and from what kind of source or which recording."""
    what = re.sub(r"[^A-Za-z0-9]+", "-", name).strip("-")[:40] or "session"
    return library.new_path(f"{time.strftime('%Y%m%d-%H%M%S')}-{what}")
