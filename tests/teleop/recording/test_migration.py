"""Recordings of the format before this one are read as today's."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from recording_frames import camera, frames

from teleop.errors import RecordingError
from teleop.frames import Camera, Intrinsics
from teleop.recording import McapSource, McapWriter, topics
from teleop.recording.migrate import migrated

T = ((1.0, 0.0, 0.0, 0.025), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
OWN = Camera(camera().depth, mirrored=True, color=Intrinsics(50.0, 50.0, 30.0, 20.0, 64, 48), T_color_depth=T)


def as_version_1(path: Path, output: Path, more: dict[str, str] | None = None) -> None:
    """The same messages with the metadata that version 1 wrote."""
    with path.open("rb") as file, output.open("wb") as out:
        reader, writer = make_reader(file), Writer(out)
        writer.start()
        assert OWN.color is not None
        record = {
            "format_version": "1",
            "software_version": "0.1.0",
            "mirrored": "true",
            "source": "x",
            "color": json.dumps(asdict(OWN.color)),
            "T_color_depth": json.dumps(T),
        }
        writer.add_metadata(topics.METADATA, record | (more or {}))
        channels: dict[int, int] = {}
        for schema, channel, message in reader.iter_messages():
            assert schema is not None
            if channel.id not in channels:
                number = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(channel.topic, channel.message_encoding, number)
            writer.add_message(channels[channel.id], message.log_time, message.data, message.publish_time)
        writer.finish()


@pytest.fixture
def new(tmp_path: Path) -> Path:
    path = tmp_path / "new.mcap"
    with McapWriter(path, OWN, source_uri="x", metadata={"seed": "7"}) as writer:
        for frame in frames(20, cam=OWN, color=True):
            writer.write_frame(frame)
    return path


def test_version_1_gives_the_same_camera_and_frames(new: Path, tmp_path: Path) -> None:
    old = tmp_path / "old.mcap"
    as_version_1(new, old)
    source = McapSource(old)
    assert source.metadata["format_version"] == "1"
    assert source.info.camera == McapSource(new).info.camera == OWN
    for first, second in zip(source.frames(), McapSource(new).frames(), strict=True):
        assert first.t_ns == second.t_ns
        np.testing.assert_array_equal(first.depth_mm, second.depth_mm)
        np.testing.assert_array_equal(first.color_rgb, second.color_rgb)


@pytest.mark.parametrize("more", [{"color": "{"}, {"color": "[1]"}, {"T_color_depth": "[[1]]"}])
def test_damaged_version_1_is_one_error(new: Path, tmp_path: Path, more: dict[str, str]) -> None:
    as_version_1(new, tmp_path / "old.mcap", more)
    with pytest.raises(RecordingError, match=r"old\.mcap: .*damaged"):
        McapSource(tmp_path / "old.mcap")


@pytest.mark.parametrize("version", ["99", "0", "-1", "2.0", "", "²"])
def test_versions_that_cannot_be_read(version: str) -> None:
    with pytest.raises(RecordingError, match="reads up to 2; install a newer"):
        migrated({"format_version": version})


def test_files_of_other_programs_stay_as_they_are() -> None:
    assert migrated({"mirrored": "true"}) == {"mirrored": "true"}
