"""``teleop push`` to the real server over a line that delays every message and loses some."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from live_server import frames, running

from benchmarks.lossy_line import lossy_line
from server.cli.push_run import PushOptions, push_frames
from teleop.frames import DepthFrame
from teleop.sources.base import SourceInfo

COUNT = 90


class Camera:
    """Three seconds of frames at 30 a second."""

    info = SourceInfo("test:", "test", frames()[0].camera, live=True, has_color=True)

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:
        for i in range(COUNT):
            yield replace(frames()[i % 60], t_ns=i * 33_333_333, seq=i)
            time.sleep(0.033)

    def close(self) -> None:
        pass


def test_delays_and_losses_cost_a_few_frames_and_no_connection(tmp_path: Path) -> None:
    with running(tmp_path) as (url, engine):
        address = f"{url.replace('http', 'ws')}/api/v1/push"
        with lossy_line(address, jitter_s=0.05, loss=0.05, seed=3) as (line, counts):
            sent = push_frames(Camera(), line, PushOptions())
        taken = engine.frames
    assert sent.connections == 1
    assert sent.sent + sent.dropped == COUNT
    assert counts.lost_frames > 0 and counts.lost_answers > 0, "the line was as bad as it should be"
    # far more than a window, although its losses alone would have filled it for good
    assert sent.sent > 4 * PushOptions().window
    assert taken > PushOptions().window
