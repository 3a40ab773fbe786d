"""``teleop push`` over loopback at 30 frames/s, every message up to 50 ms late and 1 % of them lost.

The server is ``teleop serve --source push:`` in its own process; frames are 640x480 with colour, played from memory.
"""

from __future__ import annotations

import json
import threading
import urllib.request

from rich.console import Console
from rich.table import Table
from websockets.sync.client import connect

from benchmarks.bench_chain import server
from benchmarks.lossy_line import lossy_line
from benchmarks.memory_source import memory_loop
from server.cli.push_run import PushOptions, push_frames


def _states(port: int, stop: threading.Event) -> list[dict[str, object]]:
    seen = []
    with connect(f"ws://127.0.0.1:{port}/api/v1/stream", max_size=1 << 24) as stream:
        while not stop.is_set():
            try:
                message = stream.recv(timeout=0.5)
            except TimeoutError:
                continue
            if isinstance(message, str) and (state := json.loads(message)).get("type") == "state":
                seen.append(state)
                stream.send(json.dumps({"type": "painted", "seq": state["seq"]}))
    return seen


def main(seconds: float = 60.0, jitter_ms: float = 50.0, loss: float = 0.01) -> bool:
    """Push, watch, and print what arrived. Whether nine frames of ten that were sent were tracked."""
    source = memory_loop(4.0)
    stop = threading.Event()
    states: list[dict[str, object]] = []
    with server("push:") as (port, _):
        watcher = threading.Thread(target=lambda: states.extend(_states(port, stop)))
        watcher.start()
        address = f"ws://127.0.0.1:{port}/api/v1/push"
        with lossy_line(address, jitter_ms * 1e-3, loss) as (line, counts):
            sent = push_frames(source, line, PushOptions(seconds=seconds))  # type: ignore[arg-type]
            metrics = urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics").read().decode()
        stop.set()
        watcher.join()
    taken = next(float(x.split()[1]) for x in metrics.splitlines() if x.startswith("teleop_frames_total"))
    rates = [s["source"]["fps"] for s in states if s.get("source")]  # type: ignore[index]
    table = Table("push over loopback", "value")
    offered = sent.sent + sent.dropped
    table.add_row("frames offered, at 30 frames/s", str(offered))
    table.add_row("left out by the sender, window full", f"{sent.dropped} ({100 * sent.dropped / offered:.2f} %)")
    table.add_row("lost on the line, frames and answers", f"{counts.lost_frames}, {counts.lost_answers}")
    table.add_row("taken by the engine", f"{taken:.0f} ({100 * taken / offered:.1f} %)")
    table.add_row(
        "rate seen by the console, median [frames/s]", f"{sorted(rates)[len(rates) // 2]:.1f}" if rates else "-"
    )
    table.add_row("connections", str(sent.connections))
    Console().print(table)
    return taken >= 0.9 * offered and sent.connections == 1
