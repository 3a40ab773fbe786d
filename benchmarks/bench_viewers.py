"""Twenty viewers, one of them stalled: how late the server's event loop and the engine's steps become."""

from __future__ import annotations

import os
import time

from rich.console import Console
from rich.table import Table

from benchmarks.bench_chain import server, session
from benchmarks.serving import metric, quantile, stalled_viewer, viewers

LIMIT_MS = 10.0
"""p99 of the loop's lateness."""


def main(seconds: float = 75.0, count: float = 20.0) -> bool:
    """Print lateness alone and with the viewers; False when p99 with them reaches the limit."""
    out = Console()
    table = Table(title=f"640x480 at 30 frames/s, {seconds:.0f} s each")
    for column in ("", "loop p50 ms", "loop p99 ms", "states/s, slowest viewer", "state interval p50/p99 ms", "cores"):
        table.add_column(column, justify="right" if column else "left")
    p99 = 0.0
    with server(session()) as (port, process):
        for name, steady in (("one viewer", 1), (f"{count:.0f} viewers, one stalled", int(count) - 1)):
            begun = time.monotonic()
            with viewers(port, seconds, steady) as seen:
                if steady > 1:
                    with stalled_viewer(port):
                        busy = process.cpu_times()
                        found = seen.recv()
                        after = process.cpu_times()
                        lag = [metric(port, "teleop_loop_lag_seconds", quantile=q) * 1e3 for q in ("0.5", "0.99")]
                else:
                    busy = process.cpu_times()
                    found = seen.recv()
                    after = process.cpu_times()
                    lag = [metric(port, "teleop_loop_lag_seconds", quantile=q) * 1e3 for q in ("0.5", "0.99")]
            p99 = lag[1]
            cores = (after.user + after.system - busy.user - busy.system) / (time.monotonic() - begun)
            gaps = list(found[0].gaps_ms)
            table.add_row(
                name,
                f"{lag[0]:.2f}",
                f"{lag[1]:.2f}",
                f"{min(viewer.states for viewer in found) / seconds:.1f}",
                f"{quantile(gaps, 0.5):.1f} / {quantile(gaps, 0.99):.1f}",
                f"{cores:.2f}",
            )
    out.print(table)
    out.print(f"lateness over the last minute; load of the machine {os.getloadavg()[0]:.1f}; limit {LIMIT_MS:g} ms")
    return p99 < LIMIT_MS


if __name__ == "__main__":
    main()
