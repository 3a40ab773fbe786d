"""Ten minutes with everything running, clients that come and go and requests of all kinds: memory must stay flat."""

from __future__ import annotations

import time

import httpx
import numpy as np
from rich.console import Console

from benchmarks.bench_chain import server, session
from benchmarks.serving import metric, stalled_viewer, viewers

WARM_UP = 0.25
"""Part of the time that caches and buffers may still grow in."""
LIMIT_MB_PER_MIN = 0.5
STEP_S = 2.0


def main(minutes: float = 10.0) -> bool:
    """Print memory, threads and open files over time; False when memory grows."""
    out = Console()
    seconds = minutes * 60.0
    samples: list[tuple[float, float]] = []
    with server(session()) as (port, process), viewers(port, seconds, steady=4, restless=2) as seen:
        api = httpx.Client(base_url=f"http://127.0.0.1:{port}/api/v1", timeout=10)
        begun = time.monotonic()
        while (now_s := time.monotonic() - begun) < seconds:
            with stalled_viewer(port):
                _ask_everything(api, len(samples))
                time.sleep(STEP_S)
            samples.append((now_s / 60.0, process.memory_info().rss / 2**20))
            if len(samples) % max(1, int(seconds / STEP_S / 10)) == 0:
                out.print(
                    f"{now_s / 60:5.1f} min  {samples[-1][1]:7.1f} MB  {process.num_threads()} threads  "
                    f"{process.num_fds()} files  loop p99 "
                    f"{metric(port, 'teleop_loop_lag_seconds', quantile='0.99') * 1e3:.1f} ms"
                )
        found = seen.recv()
    late = [(t, mb) for t, mb in samples if t > WARM_UP * minutes]
    slope = float(np.polyfit([t for t, _ in late], [mb for _, mb in late], 1)[0])
    spread = max(mb for _, mb in late) - min(mb for _, mb in late)
    out.print(
        f"memory after the first {WARM_UP * minutes:.1f} min: {slope:+.3f} MB/min, spread {spread:.1f} MB "
        f"(limit {LIMIT_MB_PER_MIN:g} MB/min); {found[0].states / seconds:.1f} states/s; "
        f"{found[-1].states} reconnects of a restless client"
    )
    return slope < LIMIT_MB_PER_MIN


def _ask_everything(api: httpx.Client, turn: int) -> None:
    for path in ("/state", "/health", "/ready", "/config", "/recordings", "/sessions", "/camera/head.jpg", "/access"):
        api.get(path)
    api.post("/robot/command", json={"lift_m": 0.1 + 0.1 * (turn % 2)})
    if turn % 10 == 5:
        api.post("/replay/seek", json={"position_s": 1.0})
    if turn % 30 == 15:
        api.post("/estop")
        api.post("/estop/reset")


if __name__ == "__main__":
    main()
