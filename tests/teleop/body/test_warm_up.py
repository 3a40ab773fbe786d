"""After the warm-up nothing is compiled any more: a real person's first frame is as quick as the next."""

import subprocess
import sys

SCRIPT = """
import gc
from numba.core.dispatcher import Dispatcher
from teleop.config.body import BodyConfig
from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.sources import open_source

def compiled():
    return {f"{d.py_func.__name__}{s}" for d in gc.get_objects() if isinstance(d, Dispatcher) for s in d.overloads}

tracker, source = BodyTracker(load_model(), BodyConfig()), open_source("recordings/greenhouse_demo.mcap")
tracker.warm_up(source.info.camera)
before, state, seen = compiled(), tracker.initial_state(), 0
for i, frame in enumerate(source.frames(3.0)):
    track, state = tracker.step(frame, state)
    seen += track.skeleton is not None
    if i == 40:
        break
print(seen, sorted(compiled() - before))
"""


def test_nothing_is_compiled_after_the_warm_up() -> None:
    # a process of its own: other tests have compiled here already
    told = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, check=True).stdout
    seen, late = told.split(" ", 1)
    assert int(seen) > 30
    assert late.strip() == "[]"
