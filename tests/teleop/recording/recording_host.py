"""Records again and again, each time in a fork of its own that is killed: ``python recording_host.py``.

Every line of input names a file; the answer is the fork's process id, then the time of each frame once the recorder
has taken it.
"""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

from recording_frames import camera, frames

from teleop.recording import McapWriter
from teleop.recording.recorder import AsyncRecorder

PACE_S = 0.008
"""Four times as fast as a camera: seconds of recording time pass while the fork lives."""


def record(path: Path) -> None:
    made = frames(600, color=True)
    print(os.getpid(), flush=True)
    # queue, thread and all, as a session records
    with AsyncRecorder(McapWriter(path, camera(), source_uri="x")) as recorder:
        for frame in made:
            recorder.write_frame(frame)
            recorder.write_row(frame.t_ns, {"t": frame.t_s})
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
