"""``teleop record`` before a sensor that stalls, fails, or goes on: told, watched, and what came is kept."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from live_server import frames

from server.cli.record_run import RecordOptions, record_session
from server.settings import Settings
from teleop.errors import SourceError
from teleop.frames import DepthFrame
from teleop.recording import McapSource, topics
from teleop.sources.base import SourceInfo
from teleop.sources.reconnect import Reconnecting

SETTINGS = Settings.model_validate({"sensor": {"retry_s": 0.1, "give_up_s": 2.5}})


class Sensor:
    """Ten frames, then nothing, or an error; live."""

    def __init__(self, error: str | None = None) -> None:
        self.info = SourceInfo("test:", "test", frames()[0].camera, live=True, has_color=True)
        self._error = error
        self._closed = threading.Event()

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:
        for i, frame in enumerate(frames()[:10]):
            yield replace(frame, t_ns=i * 33_333_333, color_jpeg=None)
            if self._closed.wait(0.03):
                return
        if self._error:
            raise SourceError(self._error)
        self._closed.wait(60)

    def close(self) -> None:
        self._closed.set()


def test_a_stalled_sensor_is_told_and_ends_the_recording(tmp_path: Path) -> None:
    told: list[str] = []
    path = tmp_path / "a.mcap"
    with pytest.raises(SourceError, match=r"no frames for .*cable"):
        record_session(Sensor(), path, SETTINGS, RecordOptions(), tell=told.append)
    assert len(told) == 1 and "waiting for it" in told[0]
    source = McapSource(path)
    assert source.truncated is None and source.info.frame_count == 10
    rows = [row for _, row in source.rows(topics.INPUTS)]
    assert any(row["watchdog"] for row in rows), "the watchdog held the robot, and the recording says so"
    source.close()


def test_a_lost_sensor_comes_back_within_the_recording(tmp_path: Path) -> None:
    told: list[str] = []
    plugged_in = [Sensor("pulled again")]

    def again() -> Sensor:
        if not told or not plugged_in:
            raise SourceError("no device found")
        return plugged_in.pop()

    path = tmp_path / "a.mcap"
    lasting = Reconnecting(Sensor("pulled"), again, 0.1)
    with pytest.raises(SourceError, match="pulled again"):
        record_session(lasting, path, SETTINGS, RecordOptions(color=False), tell=told.append)
    assert told[0].startswith("pulled;") and told[1] == "frames are coming again"
    source = McapSource(path)
    assert source.info.frame_count == 20 and not source.info.has_color
    assert source.metadata["color_kept"] == "no"
    source.close()
