"""The real engine, robot, body model and web server in this process, on a free port."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from itertools import islice
from pathlib import Path

import uvicorn
from fastapi import FastAPI

from robot_sim.world import World
from server.access.tokens import new_tokens
from server.app import create_app
from server.engine.engine import Engine
from server.library import Library
from server.settings import Settings, bundled_recordings
from server.stream.hub import Hub
from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.frames import DepthFrame
from teleop.recording import McapSource, McapWriter

TOKENS, TOKEN = new_tokens()
"""What the server knows, and the token of each role."""
STANDING_S, COUNT = 2.0, 60


def tracker(settings: Settings) -> BodyTracker:
    return BodyTracker(load_model(), settings.teleop.body)


@cache
def frames() -> tuple[DepthFrame, ...]:
    """Two seconds of the bundled recording in which the operator stands in the working zone, from time zero on."""
    source = McapSource(bundled_recordings() / "greenhouse_demo.mcap")
    taken = tuple(islice(source.frames(STANDING_S), COUNT))
    source.close()
    return tuple(replace(f, t_ns=f.t_ns - taken[0].t_ns, seq=i) for i, f in enumerate(taken))


def write_walk(path: Path, count: int = COUNT) -> Path:
    """A recording of them."""
    with McapWriter(path, frames()[0].camera, source_uri="made by a test") as writer:
        for frame in frames()[:count]:
            writer.write_frame(frame)
    return path


@contextmanager
def prepared(folder: Path, **settings_given: object) -> Iterator[tuple[FastAPI, Engine]]:
    """The application over a running engine, not served yet, with one bundled recording, ``walk``."""
    bundled = folder / "bundled"
    bundled.mkdir()
    write_walk(bundled / "walk.mcap")
    settings = Settings.model_validate({"operators": folder / "operators", **settings_given})
    hub = Hub(settings.stream.max_clients, settings.stream.max_events, settings.stream.history_events)
    ready = tracker(settings)
    ready.warm_up(frames()[0].camera)  # compiling takes longer than a client waits
    engine = Engine(settings, ready, World(settings.robot), hub)
    engine.start()
    library = Library(folder / "own", bundled, settings.upload.recording_mb * 1_000_000)
    try:
        yield create_app(engine, hub, library, settings, TOKENS), engine
    finally:
        engine.stop()


@contextmanager
def running(folder: Path, **settings_given: object) -> Iterator[tuple[str, Engine]]:
    """The same served on a free port; gives its URL and its engine."""
    with prepared(folder, **settings_given) as (app, engine), socket.socket() as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 16)
        listener.bind(("127.0.0.1", 0))
        listener.listen()
        server = uvicorn.Server(uvicorn.Config(app, log_level="warning", timeout_graceful_shutdown=1))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
        thread.start()
        try:
            yield f"http://127.0.0.1:{listener.getsockname()[1]}", engine
        finally:
            server.should_exit = True
            thread.join(10)
