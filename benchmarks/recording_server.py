"""The server of the recording bench: a sensor played from memory, recorded; ``python -m benchmarks.recording_server``.

Arguments: port, file to write. Runs until its input ends, then prints one JSON object.
"""

from __future__ import annotations

import json
import sys
import threading
import time
from pathlib import Path

import psutil
import uvicorn

from benchmarks.memory_source import memory_loop
from robot_sim.world import World
from server.access.tokens import load_tokens
from server.app import create_app
from server.engine.engine import Engine
from server.library import Library
from server.settings import Settings, bundled_recordings
from server.stream.hub import Hub
from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.sources.jpeg import through_jpeg


def _jpeg_share() -> float:
    """Share of a core that the recorded colour's JPEG takes at 30 frames/s, in the thread that reads the source."""
    frames = list(zip(range(30), memory_loop(1.0).frames(), strict=False))
    begin_s = time.thread_time()
    for _, frame in frames:
        through_jpeg(frame)
    return (time.thread_time() - begin_s) / len(frames) * 30


def main(port: int, output: Path) -> None:
    """Serve and record."""
    settings = Settings(port=port)
    jpeg = _jpeg_share()
    source = memory_loop(4.0)
    tracker = BodyTracker(load_model(), settings.teleop.body)
    hub = Hub(settings.stream.max_clients, settings.stream.max_events, settings.stream.history_events)
    engine = Engine(settings, tracker, World(settings.robot), hub)
    library = Library(output.parent, bundled_recordings(), 1)
    tokens, _ = load_tokens(output.with_suffix(".tokens"))
    app = create_app(engine, hub, library, settings, tokens, lambda: settings)
    web = uvicorn.Server(uvicorn.Config(app, port=port, log_level="error", ws_per_message_deflate=False))
    thread = threading.Thread(target=web.run, daemon=True)
    engine.start()
    thread.start()
    session = engine.open("memory", source, False, output)  # type: ignore[arg-type]
    recorder = session.recorder
    assert recorder is not None
    begin_s = time.monotonic()
    print("READY", flush=True)
    sys.stdin.readline()
    seconds = time.monotonic() - begin_s
    me = psutil.Process()
    writer_s = next(t.user_time + t.system_time for t in me.threads() if t.id == recorder.thread_id)
    spent = me.cpu_times()
    taken, missed, given = engine.frames, engine.dropped, source.given
    engine.close_session(session.id)
    status = recorder.status
    found = {
        "seconds": seconds,
        "given": given,
        "written": status.frames_written,
        "dropped": status.frames_dropped,
        "colors_dropped": status.colors_dropped,
        "error": status.error,
        "taken": taken,
        "missed": missed,
        "writer_share": writer_s / seconds,
        "jpeg_share": jpeg,
        "server_cores": (spent.user + spent.system) / seconds,
        "bytes": output.stat().st_size,
    }
    web.should_exit = True
    thread.join(10)
    engine.stop()
    print(json.dumps(found), flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]), Path(sys.argv[2]))
