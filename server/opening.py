"""From what a user or a client names to an open session: clients name recordings and sensors, never paths."""

from __future__ import annotations

from pathlib import Path

from server.engine.engine import Engine
from server.engine.session import Session
from server.errors import Refused
from server.library import Library
from teleop.sources import open_source

LIVE_SCHEMES = ("openni2:", "freenect:", "realsense:", "orbbec:", "virtual:")


def open_named(engine: Engine, library: Library, name: str, *, loop: bool, record: bool = False) -> Session:
    """Open what a client asks for. Raises Refused (403 a path, 404 an unknown recording) and TeleopError."""
    scheme = next((s for s in LIVE_SCHEMES if name.lower().startswith(s)), None)
    if scheme is None:
        return engine.open(name, open_source(str(library.find(name).path)), loop)
    if "/" in name or "\\" in name or ".." in name:
        raise Refused(403, "files of this computer are opened on its command line only; upload a recording instead")
    if engine.session is not None and engine.session.info.live:
        engine.close_session(engine.session.id)  # a sensor can be opened once
    return engine.open(name, open_source(name), loop)


def open_path(engine: Engine, uri: str, *, loop: bool, record: bool = False) -> Session:
    """Open what the command line names: any path or URI. A recording goes by its bare name."""
    name = Path(uri).stem if uri.endswith(".mcap") else uri
    return engine.open(name, open_source(uri), loop)
