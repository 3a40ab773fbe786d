"""A running server in this process whose camera does what a script says, frame by frame, in real time."""

from __future__ import annotations

import socket
import tempfile
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import httpx
import numpy as np
import uvicorn

from benchmarks.faults.actors import CAMERA, POSES, pictures
from benchmarks.faults.watch import Watch
from robot_sim.world import World
from server.access.tokens import new_tokens
from server.app import create_app
from server.engine.engine import Engine
from server.library import Library
from server.settings import Settings
from server.stream.hub import Hub
from teleop.body.model import BodyModel, load_model
from teleop.body.tracker import BodyTracker, TrackerState
from teleop.config.body import BodyConfig
from teleop.errors import SourceError
from teleop.frames import DepthFrame
from teleop.skeleton import Skeleton, Track
from teleop.sources.base import SourceInfo

FPS = 15.0
Spoil = Callable[[Skeleton], Skeleton]


class ScriptedCamera:
    """A live source that hands on whatever is put into it, in any order, with any stamp."""

    def __init__(self) -> None:
        self.info = SourceInfo(uri="scripted:", kind="scripted", camera=CAMERA, live=True, has_color=True)
        self._queue: deque[DepthFrame] = deque()
        self._changed = threading.Condition()
        self._closed = False
        self.unplugged = False

    def put(self, frame: DepthFrame) -> None:
        with self._changed:
            self._queue.append(frame)
            self._changed.notify_all()

    def unplug(self) -> None:
        with self._changed:
            self.unplugged = True
            self._changed.notify_all()

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:  # noqa: ARG002
        while True:
            with self._changed:
                self._changed.wait_for(lambda: bool(self._queue) or self._closed or self.unplugged)
                if self._closed:
                    return
                if self.unplugged:
                    raise SourceError("the camera is gone; check its cable, then open it again")
                frame = self._queue.popleft()
            yield frame

    def close(self) -> None:
        with self._changed:
            self._closed = True
            self._changed.notify_all()


class SpoiledTracker(BodyTracker):
    """The real body tracker; its skeletons can be spoiled on the way out."""

    def __init__(self, model: BodyModel, config: BodyConfig) -> None:
        super().__init__(model, config)
        self.spoil: Spoil | None = None

    def step(self, frame: DepthFrame, state: TrackerState) -> tuple[Track, TrackerState]:
        track, state = super().step(frame, state)
        spoil = self.spoil
        if spoil is not None and track.skeleton is not None:
            track = replace(track, skeleton=spoil(track.skeleton))
        return track, state


class Stage:
    """The operator's side: what stands before the camera, and what happens to its frames on the way."""

    def __init__(self, url: str, engine: Engine, tracker: SpoiledTracker, watch: Watch) -> None:
        self.api = httpx.Client(base_url=f"{url}/api/v1", timeout=10.0)
        self.watch = watch
        self.tracker = tracker
        self._engine = engine
        self._camera = ScriptedCamera()
        self._stop = threading.Event()
        self._seq = 0
        self.refused: list[str] = []
        """Codes of requests that the server refused, see server.api.problems."""
        self.calm("forward")
        self._feeder = threading.Thread(target=self._feed, daemon=True)

    def calm(self, pose: str) -> None:
        """Somebody stands in a pose and everything works."""
        self.scene: Callable[[int], DepthFrame | None] = lambda i: pictures(pose)[i % len(pictures(pose))]
        self.stamp: Callable[[int, int], int] = lambda _i, now_ns: now_ns
        self.tracker.spoil = None

    def open(self) -> None:
        """Plug a fresh camera in."""
        self._camera = ScriptedCamera()
        self._engine.open("scripted camera", self._camera, False)

    def start(self) -> None:
        for pose in POSES:
            pictures(pose)
        self.open()
        self._feeder.start()

    def unplug(self) -> None:
        self._camera.unplug()

    @property
    def camera_gone(self) -> bool:
        return self._camera.unplugged

    def post(self, path: str, body: dict[str, object] | None = None, client: str = "") -> None:
        """Ask the server for something; client: who asks, 16 letters or digits, for the lease."""
        response = self.api.post(path, json=body, headers={"X-Teleop-Client": client} if client else {})
        if response.is_error:
            self.refused.append(str(response.json().get("code")))

    def await_mode(self, mode: str, most_s: float = 10.0) -> None:
        """Wait for a mode. Raises RuntimeError when it does not come."""
        end = time.monotonic() + most_s
        while time.monotonic() < end:
            if self.watch.last is not None and self.watch.last["mode"] == mode:
                return
            time.sleep(0.01)
        raise RuntimeError(f"mode {mode} was not reached; it is {self.watch.last and self.watch.last['mode']}")

    def engage(self, mode: str, most_s: float = 20.0) -> None:
        """Engage who is seen, as often as it takes, until a mode is reached. Raises RuntimeError when it is not."""
        end, asked_s = time.monotonic() + most_s, 0.0
        while time.monotonic() < end:
            state = self.watch.last
            if state is not None and state["mode"] == mode:
                return
            # a change of place is a new operator to the tracker, and ends control
            if state is not None and state["mode"] == "seen" and time.monotonic() - asked_s > 0.5:
                asked_s = time.monotonic()
                self.post("/engage")
            time.sleep(0.02)
        raise RuntimeError(f"mode {mode} was not reached; it is {self.watch.last and self.watch.last['mode']}")

    def close(self) -> None:
        self._stop.set()
        self._feeder.join(2.0)
        self.api.close()

    def _feed(self) -> None:
        due = time.monotonic()
        while not self._stop.is_set():
            self._seq += 1
            frame = self.scene(self._seq)
            if frame is not None:
                self._camera.put(replace(frame, t_ns=self.stamp(self._seq, time.monotonic_ns()), seq=self._seq))
            due = max(due + 1.0 / FPS, time.monotonic() - 0.2)
            self._stop.wait(max(0.0, due - time.monotonic()))


def with_joints(change: Callable[[np.ndarray], np.ndarray]) -> Spoil:
    """A spoiling of the joints (20, 3) [m], confidence full."""
    return lambda s: Skeleton(s.t_ns, change(s.joints_m.copy()), np.ones(len(s.joints_m)))


@contextmanager
def stage() -> Iterator[Stage]:
    """The whole product running; everything is closed at the end."""
    settings = Settings.model_validate({"loop": False, "stream": {"state_hz": 60.0}})
    hub = Hub(settings.stream.max_clients, settings.stream.max_events, settings.stream.history_events)
    tracker = SpoiledTracker(load_model(), settings.teleop.body)
    tracker.warm_up(CAMERA)
    engine = Engine(settings, tracker, World(settings.robot), hub)
    engine.start()
    with tempfile.TemporaryDirectory() as folder, socket.socket() as listener:
        library = Library(Path(folder) / "own", Path(folder) / "bundled", 1_000_000)
        app = create_app(engine, hub, library, settings, new_tokens()[0])
        listener.bind(("127.0.0.1", 0))
        listener.listen()
        server = uvicorn.Server(uvicorn.Config(app, log_level="warning", timeout_graceful_shutdown=1))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
        thread.start()
        port = listener.getsockname()[1]
        try:
            with Watch(f"ws://127.0.0.1:{port}/api/v1/stream", settings.robot) as watch:
                on = Stage(f"http://127.0.0.1:{port}", engine, tracker, watch)
                on.start()
                try:
                    yield on
                finally:
                    on.close()
        finally:
            server.should_exit = True
            thread.join(10)
            engine.stop()
