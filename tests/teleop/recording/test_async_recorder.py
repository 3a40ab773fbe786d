"""The recorder behind its queue: nothing lost in order, losses under pressure counted, errors end only it."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import numpy as np
import pytest
from recording_frames import camera, frames

from teleop.intent_types import Event
from teleop.recording import McapSource, McapWriter, topics
from teleop.recording.recorder import REASON_DROPPED, REASON_STOPPED, AsyncRecorder
from teleop.skeleton import Skeleton


class SlowWriter(McapWriter):
    """A real writer on a disk that stalls until it is released."""

    def __init__(self, path: Path) -> None:
        super().__init__(path, camera(), source_uri="x")
        self.release = threading.Event()
        self.stalled = threading.Event()

    def write_frame(self, frame) -> None:  # type: ignore[no-untyped-def]
        self.stalled.set()
        assert self.release.wait(60)
        super().write_frame(frame)


def skeleton(t_ns: int) -> Skeleton:
    return Skeleton(t_ns, np.zeros((20, 3)), np.ones(20))


def test_everything_arrives_in_order(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    made = frames(120, color=True)
    with AsyncRecorder(McapWriter(path, camera(), source_uri="x"), capacity=1000) as recorder:
        for frame in made:
            recorder.write_frame(frame)
            recorder.write_skeleton(frame.t_ns, skeleton(frame.t_ns))
            recorder.write_row(frame.t_ns, {"t": frame.t_s})
            recorder.write_input(frame.t_ns, {"tick": frame.seq})
    status = recorder.status
    assert (status.frames_written, status.frames_dropped, status.colors_dropped) == (120, 0, 0)
    assert (status.frames_queued, status.error) == (0, None)
    source = McapSource(path)
    assert source.truncated is None
    for frame, read in zip(made, source.frames(), strict=True):
        np.testing.assert_array_equal(frame.depth_mm, read.depth_mm)
        assert read.color_rgb is not None
    assert [row["tick"] for _, row in source.rows(topics.INPUTS)] == list(range(120))
    assert recorder.close().error is None


def test_colour_gives_way_before_depth_and_events_never_do(tmp_path: Path) -> None:
    told: list[Event] = []
    writer = SlowWriter(tmp_path / "a.mcap")
    recorder = AsyncRecorder(writer, capacity=10, on_event=told.append)
    made = frames(30, color=True)
    recorder.write_frame(made[0])
    assert writer.stalled.wait(60)
    for frame in made[1:]:
        recorder.write_frame(frame)
        recorder.write_skeleton(frame.t_ns, skeleton(frame.t_ns))
        recorder.write_event(Event(frame.t_ns, "test", "test.reason"))
    assert recorder.status.frames_queued == 10
    writer.release.set()
    status = recorder.close()
    # One frame is being written and counts as queued: 4 more keep their colour, 5 lose it, the rest are dropped.
    assert (status.frames_written, status.frames_dropped, status.colors_dropped) == (10, 20, 5)
    assert status.skeletons_dropped == 26
    source = McapSource(tmp_path / "a.mcap")
    assert [f.t_ns for f in source.frames()] == [f.t_ns for f in made[:10]]
    assert len(source.file.topics[topics.COLOR].t_ns) == 5
    events = [row for _, row in source.rows(topics.EVENTS)]
    assert sum(row["kind"] == "test" for row in events) == 29
    reported = [row["detail"] for row in events if row["kind"] == "recording"]
    assert [detail.split(" left")[0] for detail in reported] == ["skeletons", "colour", "depth", "in all"]
    assert reported[-1] == "in all left out: skeletons 26, colour 5, depth 20"
    assert [event.detail for event in told] == reported and {event.reason for event in told} == {REASON_DROPPED}


def test_a_write_error_ends_the_recording_and_nothing_else(tmp_path: Path) -> None:
    told: list[Event] = []
    stopped = threading.Event()

    def tell(event: Event) -> None:
        told.append(event)
        stopped.set()

    recorder = AsyncRecorder(McapWriter(tmp_path / "a.mcap", camera(), source_uri="x"), on_event=tell)
    made = frames(6)
    for frame in [*made[:4], made[1]]:  # the source was sought: time runs backwards
        recorder.write_frame(frame)
    assert stopped.wait(60)
    recorder.write_frame(made[5])
    status = recorder.close()
    assert status.error is not None and "must increase" in status.error
    assert status.frames_written == 4
    assert [event.reason for event in told] == [REASON_STOPPED]
    source = McapSource(tmp_path / "a.mcap")
    assert source.truncated is None
    assert source.info.frame_count == 4


def test_a_disk_that_hangs_does_not_hang_the_caller(tmp_path: Path) -> None:
    writer = SlowWriter(tmp_path / "a.mcap")
    recorder = AsyncRecorder(writer)
    recorder.write_frame(frames(1)[0])
    status = recorder.close(timeout_s=0.05)
    assert status.error is not None and "did not take" in status.error
    writer.release.set()


@pytest.mark.parametrize("stream_goes_on", [True, False])
def test_what_is_written_reaches_the_disk_while_the_camera_is_silent(tmp_path: Path, stream_goes_on: bool) -> None:
    """After the last frame the clock of the messages stands still; a crash must not lose what the watchdog did."""
    path = tmp_path / "a.mcap"
    with AsyncRecorder(McapWriter(path, camera(), source_uri="x"), flush_s=0.2) as recorder:
        made = frames(3)
        for frame in made:
            recorder.write_frame(frame)
        recorder.write_event(Event(made[-1].t_ns, "watchdog", "stop.no_frame"))
        for number in range(40):
            if stream_goes_on:
                recorder.write_input(made[-1].t_ns, {"tick": number})
            time.sleep(0.03)
        # what a process that is killed now leaves behind
        (tmp_path / "killed.mcap").write_bytes(path.read_bytes())
    left = McapSource(tmp_path / "killed.mcap")
    assert "stop.no_frame" in [row["reason"] for _, row in left.rows(topics.EVENTS)]
    assert len(list(left.rows(topics.INPUTS))) >= (25 if stream_goes_on else 0)
    assert left.info.frame_count == 3
    whole = McapSource(path)
    assert len(list(whole.frames())) == 3 and len(list(whole.rows(topics.INPUTS))) == (40 if stream_goes_on else 0)


@pytest.mark.parametrize("count", [0, 1])
def test_short_recordings(tmp_path: Path, count: int) -> None:
    with AsyncRecorder(McapWriter(tmp_path / "a.mcap", camera(), source_uri="x")) as recorder:
        for frame in frames(count):
            recorder.write_frame(frame)
    assert recorder.status.frames_written == count
    assert recorder.status.error is None
