"""Records again and again, each time in a fork of its own that is killed: ``python recording_host.py``.

Every line of input names a file; the answer is the fork's process id, then the time of each frame once it is written.
"""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

from recording_frames import camera, frames

from teleop.recording import McapWriter

PACE_S = 0.002
"""Fifteen times as fast as a camera: moments of recording time pass while the fork lives."""


def record(path: Path) -> None:
    made = frames(600, color=True)
    print(os.getpid(), flush=True)
    with McapWriter(path, camera(), source_uri="x") as writer:
        for frame in made:
            writer.write_frame(frame)
            writer.write_row(frame.t_ns, {"t": frame.t_s})
            print(frame.t_ns, flush=True)
            time.sleep(PACE_S)


if __name__ == "__main__":
    for line in sys.stdin:
        child = os.fork()
        if child == 0:
            record(Path(line.strip()))
            os._exit(0)
        os.waitpid(child, 0)
        print("END", flush=True)
