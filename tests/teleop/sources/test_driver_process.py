"""Drivers in processes of their own: real libOpenNI2 files, and what a library may do to its process."""

from __future__ import annotations

import os
import signal
import threading
from pathlib import Path

import numpy as np
import pytest
from oni_file import write_oni

from teleop.errors import SourceError
from teleop.sources import open_source
from teleop.sources.driver_process import DriverProcess
from teleop.sources.probe import probe


@pytest.fixture(scope="module")
def oni(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if probe("openni2").library is None:
        pytest.skip("libOpenNI2 or the package openni is not installed")
    path = tmp_path_factory.mktemp("oni") / "a.oni"
    write_oni(path, [np.full((480, 640), 900 + i, np.uint16) for i in range(30)])
    return path


def alive(process_id: int) -> bool:
    try:
        os.kill(process_id, 0)
    except ProcessLookupError:
        return False
    return True


def test_a_file_is_played_again_and_again_from_anywhere(oni: Path) -> None:
    source = open_source(str(oni))
    assert isinstance(source, DriverProcess)
    for start_s, first in ((0.0, 900), (0.5, 916), (0.0, 900), (0.9, 928)):
        values = [int(f.depth_mm[0, 0]) for f in source.frames(start_s)]
        assert values == list(range(first, 930))
    begun = source.frames()
    assert next(begun).depth_mm[5, 5] == 900  # and left in the middle
    assert not next(source.frames()).depth_mm.flags.writeable
    child = source.process_id
    source.close()
    source.close()
    assert not alive(child)


@pytest.mark.parametrize("how", [signal.SIGSEGV, signal.SIGABRT, signal.SIGKILL])
def test_a_library_that_crashes_is_one_error(oni: Path, how: signal.Signals) -> None:
    source = open_source(str(oni))
    assert isinstance(source, DriverProcess)
    frames = source.frames()
    next(frames)
    os.kill(source.process_id, how)
    with pytest.raises(SourceError, match=rf"a\.oni: the sensor's library crashed \({how.name}\)"):
        list(frames)
    source.close()


def test_a_library_that_hangs_is_ended(oni: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("teleop.sources.driver_process.FILE_SILENCE_S", 0.3)
    source = open_source(str(oni))
    assert isinstance(source, DriverProcess)
    os.kill(source.process_id, signal.SIGSTOP)
    with pytest.raises(SourceError, match="did not answer"):
        list(source.frames())
    child = source.process_id
    source.close()
    assert not alive(child)


def test_closing_from_another_thread_ends_the_frames(oni: Path) -> None:
    source = open_source(str(oni))
    frames = source.frames()
    next(frames)
    closer = threading.Thread(target=source.close)
    closer.start()
    rest = list(frames)  # what had arrived, then the end; no error
    closer.join(10)
    assert len(rest) < 30
    assert not closer.is_alive()


def test_a_wrong_device_leaves_no_process_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    started: list[int] = []
    original = DriverProcess._opened

    def watched(self: DriverProcess) -> object:
        started.append(self.process_id)
        return original(self)

    monkeypatch.setattr(DriverProcess, "_opened", watched)
    with pytest.raises(SourceError):
        open_source("freenect:not-a-number")
    assert len(started) == 1 and not alive(started[0])
