"""Memory of ``teleop track`` on a 640x480 session: the largest resident size, and what takes it, step by step.

The first run compiles the kernels (LLVM takes about 130 MB for that), later ones load them; both are shown.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks.bench_chain import session
from teleop.evaluation.memory import peak_memory_mb

_STEPS = """
import sys
def show(what):
    with open("/proc/self/status") as status:
        kb = {line.split(":")[0]: int(line.split()[1]) for line in status if line.startswith(("VmRSS", "RssFile"))}
    shared = kb["RssFile"] * 1.024e-3
    print(f"{what:24s} {kb['VmRSS'] * 1.024e-3:6.0f} MB, of it mapped files {shared:.0f} MB", flush=True)
show("Python")
import numpy, cv2
show("+ numpy, OpenCV")
import numba
show("+ numba (LLVM)")
from server.cli.track_run import BodyTracker, Pipeline, load_config, load_model, open_source, rows
show("+ teleop")
config = load_config(None, False)
tracker = BodyTracker(load_model(), config.body)
show("+ body model")
source = open_source(sys.argv[1])
show("+ recording")
tracker.warm_up(source.info.camera)
show("+ kernels")
for n, _ in enumerate(rows(source, Pipeline(tracker, config), [])):
    if n == 60:
        break
show("after 60 frames")
"""


def main() -> None:
    """Print the steps and the peaks."""
    teleop = str(Path(sys.executable).with_name("teleop"))
    path = session()
    with tempfile.TemporaryDirectory() as scratch:
        track = [teleop, "track", str(path), "--output", f"{scratch}/rows.jsonl"]
        cold = ["env", f"NUMBA_CACHE_DIR={scratch}/kernels", *track]
        print(f"teleop track, kernels compiled first: {peak_memory_mb(cold):.0f} MB")
        peak_memory_mb(track)
        print(f"teleop track, kernels there:          {peak_memory_mb(track):.0f} MB (10^6 bytes)")
    subprocess.run([sys.executable, "-c", _STEPS, str(path)], check=True)


if __name__ == "__main__":
    main()
