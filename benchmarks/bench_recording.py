"""640x480 depth and colour at 30 frames/s recorded, with tracking, simulation and the console on two cores.

Frames come from memory, as a sensor gives them; the console runs in headless Chromium beside the server. Reached
when not one depth frame is missing in the file and the writer takes less than a quarter of a core.
"""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.bench_chain import browse, chromium, listen
from teleop.recording import McapSource

WRITER_SHARE = 0.25


def main(minutes: float = 5.0) -> bool:
    """Record, then read the file back. Whether the figures were reached."""
    with socket.socket() as probe, tempfile.TemporaryDirectory(dir="build") as folder:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
        probe.close()
        path = Path(folder) / "session.mcap"
        command = [sys.executable, "-m", "benchmarks.recording_server", str(port), str(path)]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as server:
            assert server.stdin is not None and server.stdout is not None
            while (line := server.stdout.readline()) != "READY\n":
                if not line:
                    raise SystemExit("bench: the server did not start")
            end_s = time.monotonic() + 60 * minutes
            (browse if chromium() else listen)(port, end_s - time.monotonic())
            print(file=server.stdin, flush=True)
            found = json.loads(server.stdout.readlines()[-1])
        source = McapSource(path)
        stamps = source.file.topics["/camera/depth/image_raw"].t_ns
        missing = int(np.sum(np.maximum(np.round(np.diff(stamps) * 30e-9) - 1, 0)))
        lost = max(0, found["given"] - len(stamps))
        source.close()
    table = Table("recording, 640x480 depth and colour at 30 frames/s", "value")
    client = "console in headless Chromium" if chromium() else "websocket client"
    table.add_row("length, with", f"{found['seconds']:.0f} s, {client}")
    table.add_row("depth frames given, recorded, lost", f"{found['given']}, {len(stamps)}, {lost}")
    table.add_row("holes between the stamps in the file", str(missing))
    table.add_row("dropped by the recorder: depth, colour", f"{found['dropped']}, {found['colors_dropped']}")
    table.add_row("tracked; replaced by a newer one before", f"{found['taken']}; {found['missed']}")
    table.add_row("writer", f"{found['writer_share']:.3f} of a core")
    table.add_row("JPEG of the colour, there and back", f"{found['jpeg_share']:.3f} of a core")
    table.add_row("server in all", f"{found['server_cores']:.2f} cores")
    table.add_row("size", f"{found['bytes'] / 1e6 / found['seconds'] * 60:.0f} MB a minute")
    table.add_row("cores, load of the machine", f"{len(os.sched_getaffinity(0))}, {os.getloadavg()[0]:.1f}")
    Console().print(table)
    return lost == 0 and missing == 0 and found["error"] is None and found["writer_share"] < WRITER_SHARE
