"""What is in memory once all is compiled is not walked again by the garbage collector, which would stop the robot."""

from __future__ import annotations

import gc
from pathlib import Path

from live_server import prepared, write_walk

from teleop.recording import McapSource


def test_the_first_source_frees_the_collector_of_what_is_there(tmp_path: Path) -> None:
    walk = write_walk(tmp_path / "session.mcap")
    gc.unfreeze()
    try:
        with prepared(tmp_path) as (_, engine):
            assert gc.get_freeze_count() == 0
            engine.open("first", McapSource(walk), loop=True)
            spared = gc.get_freeze_count()
            assert spared > 100_000, "modules and kernels alone are more"
            assert len(gc.get_objects()) < spared
            engine.open("second", McapSource(walk), loop=True)
            assert gc.get_freeze_count() <= spared, "what sessions leave is collected as ever"
    finally:
        gc.unfreeze()
