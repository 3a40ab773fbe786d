"""Every kind of URI opens its source, or says in one line what is legal."""

from __future__ import annotations

from pathlib import Path

import pytest

from teleop.errors import RecordingError, SourceError, TeleopError
from teleop.sources import LEGAL_URIS, open_source


@pytest.mark.parametrize("uri", ["", "kinect:", "http://host/a", "nothing_here", "some/folder/", "rtsp:1"])
def test_a_wrong_uri_names_the_legal_ones(uri: str) -> None:
    with pytest.raises(SourceError) as raised:
        open_source(uri)
    assert LEGAL_URIS in str(raised.value)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("uri", "words"),
    [
        ("missing.mcap", "no recording at missing.mcap"),
        ("push:", "teleop serve --source push:"),
        ("freenect:first", "by its index"),
        ("openni2:missing.oni", "no file missing.oni"),
        ("realsense:missing.bag", "no file missing.bag"),
        ("REALSENSE:missing.db3", "no file missing.db3"),
    ],
)
def test_a_right_uri_with_nothing_behind_it(uri: str, words: str) -> None:
    with pytest.raises(TeleopError, match=words):
        open_source(uri)


def test_a_file_of_another_kind(tmp_path: Path) -> None:
    path = tmp_path / "video.mp4"
    path.write_bytes(b"ftyp" * 100)
    with pytest.raises(RecordingError, match="not an MCAP file"):
        open_source(str(path))
    with pytest.raises(SourceError, match="has no depth"):
        open_source(str(tmp_path))


def test_a_path_may_hold_a_colon(tmp_path: Path) -> None:
    folder = tmp_path / "virtual:"
    folder.mkdir()
    with pytest.raises(SourceError, match="has no depth"):
        open_source(str(folder))


def test_the_rendered_operator_opens() -> None:
    source = open_source("virtual:")
    frame = next(iter(source.frames()))
    assert frame.depth_mm.any()
    source.close()
