"""The real engine, robot and web server in this process, on a free port, with a body model of one leaf.

The model votes every joint where the pixel is, so a skeleton comes out and every stage runs; what it is worth is
tested elsewhere.
"""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import uvicorn

from robot_sim.world import World
from server.app import create_app
from server.engine.engine import Engine
from server.library import Library
from server.settings import Settings
from server.stream.hub import Hub
from teleop.body.model import BodyModel
from teleop.body.parts import N_PARTS
from teleop.body.tracker import BodyTracker
from teleop.frames import Camera, DepthFrame, kinect_v1
from teleop.joints import BONES, N_JOINTS
from teleop.recording import McapWriter

CAMERA = Camera(kinect_v1(160, 120))


def one_leaf_model() -> BodyModel:
    """One tree, one leaf: every part as likely as the other, every joint at the pixel itself."""
    return BodyModel(
        roots=np.zeros(1, np.int32),
        offsets=np.zeros((1, 4), np.int16),
        thresholds_mm=np.zeros(1, np.int16),
        children=np.zeros(1, np.int32),
        leaves=np.zeros(1, np.int32),
        leaf_parts=np.full((1, N_PARTS), 255 // N_PARTS, np.uint8),
        vote_joint=np.arange(N_JOINTS, dtype=np.uint8)[None],
        vote_mm=np.zeros((1, N_JOINTS, 3), np.int16),
        vote_spread=np.full((1, N_JOINTS), 20, np.uint8),
        bandwidth_m=np.full(N_JOINTS, 0.1),
        reference=np.ones(N_JOINTS),
        bones_m=np.full(len(BONES), 0.25),
        max_depth=1,
        meta={},
    )


def tracker(settings: Settings) -> BodyTracker:
    return BodyTracker(one_leaf_model(), settings.teleop.body)


def frame(number: int, step_ns: int = 33_333_333, z_mm: int = 2300) -> DepthFrame:
    """A board the size of a person before a wall."""
    k = CAMERA.depth
    v, u = np.mgrid[: k.height, : k.width]
    depth = np.full((k.height, k.width), 4200, np.uint16)
    z_m = z_mm / 1000
    depth[(abs(u - k.cx) < 0.2 * k.fx / z_m) & (abs(v - k.cy) < 0.85 * k.fy / z_m)] = z_mm
    depth[0, number % k.width] = 0
    return DepthFrame(number * step_ns, depth, CAMERA, np.full((120, 160, 3), 128, np.uint8), number)


def write_walk(path: Path, count: int = 60) -> Path:
    """A recording of the board."""
    with McapWriter(path, CAMERA, source_uri="made by a test") as writer:
        for i in range(count):
            writer.write_frame(frame(i))
    return path


@contextmanager
def running(folder: Path, **settings_given: object) -> Iterator[tuple[str, Engine]]:
    """A server with one bundled recording, ``walk``; gives its URL and its engine."""
    bundled = folder / "bundled"
    bundled.mkdir()
    write_walk(bundled / "walk.mcap")
    settings = Settings.model_validate(settings_given)
    hub = Hub(settings.stream.max_clients, settings.stream.max_events)
    engine = Engine(settings, tracker(settings), World(settings.robot), hub)
    engine.start()
    library = Library(folder / "own", bundled, settings.upload.recording_mb * 1_000_000)
    with socket.socket() as listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 16)
        listener.bind(("127.0.0.1", 0))
        listener.listen()
        app = create_app(engine, hub, library, settings)
        server = uvicorn.Server(uvicorn.Config(app, log_level="warning", timeout_graceful_shutdown=1))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
        thread.start()
        try:
            yield f"http://127.0.0.1:{listener.getsockname()[1]}", engine
        finally:
            server.should_exit = True
            thread.join(10)
            engine.stop()
