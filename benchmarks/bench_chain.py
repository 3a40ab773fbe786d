"""The whole chain at 640x480: server, tracker and simulation replay a rendered session at 30 frames/s.

Once with a plain websocket client that acknowledges every state at once, once with the real console in headless
Chromium (software rendering), where "total" ends when the skeleton's overlay is painted.
"""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import psutil
from rich.console import Console
from rich.table import Table
from websockets.sync.client import connect

from teleop.data import data_root

_SESSION = Path("build/bench_640x480.mcap")
CHROMIUM_FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]


def session() -> Path:
    """A 640x480 session of 20 s at 30 frames/s: engaging, driving, working; rendered once, then kept in build/."""
    if not _SESSION.exists():
        _SESSION.parent.mkdir(exist_ok=True)
        person = "makehuman" if data_root() else "builtin"
        part = _SESSION.with_name("bench_part.mcap")
        source = f"virtual:{person},seed=7,size=640x480,fps=30"
        command = [_teleop(), "convert", source, str(part), "--force", "--from", "4", "--seconds", "20"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        part.rename(_SESSION)
    return _SESSION


def _teleop() -> str:
    return str(Path(sys.executable).with_name("teleop"))


@contextmanager
def server(source: Path, environment: Mapping[str, str] | None = None) -> Iterator[tuple[int, psutil.Process]]:
    """``teleop serve`` on a free port, with more environment variables; yields the port and the process."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    command = [_teleop(), "serve", "--port", str(port), "--source", str(source), "--loop"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, env={**os.environ, **(environment or {})})
    try:
        for _ in range(600):
            if process.poll() is not None:
                raise SystemExit("bench: the server did not start")
            try:
                urllib.request.urlopen(f"http://127.0.0.1:{port}/api/v1/health", timeout=1).close()
                break
            except OSError:
                time.sleep(0.2)
        yield port, psutil.Process(process.pid)
    finally:
        process.terminate()
        process.wait(20)


def listen(port: int, seconds: float) -> None:
    """Take and acknowledge states for a while, as a console that paints in no time."""
    with connect(f"ws://127.0.0.1:{port}/api/v1/stream", max_size=None) as stream:
        stream.send(json.dumps({"type": "view", "image": "depth", "head": False}))
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            message = stream.recv()
            if isinstance(message, str) and (state := json.loads(message))["type"] == "state":
                stream.send(json.dumps({"type": "painted", "seq": state["seq"]}))


def chromium() -> str | None:
    """The Chromium to drive, or None."""
    return os.environ.get("CHROMIUM") or shutil.which("chromium")


def browse(port: int, seconds: float) -> None:
    """The real console for a while."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium(), args=CHROMIUM_FLAGS)
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.goto(f"http://127.0.0.1:{port}/")
        page.wait_for_timeout(seconds * 1e3)
        browser.close()


def main(seconds: float = 40.0) -> None:
    """Print frames per second, latency per stage and processor time, both ways."""
    out = Console()
    source = session()
    for name, client in (("websocket client", listen), ("console in headless Chromium", browse)):
        if client is browse and chromium() is None:
            out.print("no Chromium on this system: console not measured")
            continue
        with server(source) as (port, process):
            client(port, 5.0)
            busy = process.cpu_times()
            start = time.monotonic()
            client(port, seconds)
            spent = time.monotonic() - start
            after = process.cpu_times()
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/api/v1/state") as reply:
                state = json.load(reply)
            cores = (after.user + after.system - busy.user - busy.system) / spent
            memory_mb = process.memory_info().rss / 2**20
        table = Table(title=f"640x480 at 30 frames/s, {name}, {seconds:.0f} s")
        for column in ("stage", "p50 ms", "p95 ms"):
            table.add_column(column, justify="left" if column == "stage" else "right")
        for stage, figure in state["latency_ms"].items():
            table.add_row(stage, f"{figure['p50']:.1f}", f"{figure['p95']:.1f}")
        out.print(table)
        out.print(
            f"{state['source']['fps']:.1f} frames/s through tracker and simulation; "
            f"server {cores:.2f} cores, {memory_mb:.0f} MB; load of the machine {os.getloadavg()[0]:.1f}"
        )


if __name__ == "__main__":
    main()
