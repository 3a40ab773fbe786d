"""A disk that is full: the recording ends with an event, the file is whole, and who records goes on."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from recording_frames import frames

from teleop.recording import McapSource, topics

HERE = Path(__file__).parent
RECORD = """
import json, resource, sys
sys.path.insert(0, sys.argv[2])
from recording_frames import camera, frames
from teleop.recording import McapWriter
from teleop.recording.recorder import AsyncRecorder
told = []
recorder = AsyncRecorder(McapWriter(sys.argv[1], camera(), source_uri="x"), capacity=10000, on_event=told.append)
if int(sys.argv[3]):
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[3]), int(sys.argv[3])))
for frame in frames(400):
    recorder.write_frame(frame)
    recorder.write_row(frame.t_ns, {"t": frame.t_s})
status = recorder.close()
print(json.dumps({"error": status.error, "written": status.frames_written, "told": [e.reason for e in told]}))
"""


def record(path: Path, limit_bytes: int) -> dict[str, object]:
    command = [sys.executable, "-c", RECORD, str(path), str(HERE), str(limit_bytes)]
    child = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert child.returncode == 0, child.stderr
    return dict(json.loads(child.stdout))


def check(path: Path, found: dict[str, object], words: str) -> None:
    assert words in str(found["error"]) and "can be opened" in str(found["error"])
    assert found["told"] == ["recording.stopped"]
    source = McapSource(path)
    assert source.truncated is None, "it has its closing records"
    read = [frame.t_ns for frame in source.frames()]
    assert 20 < len(read) < 400
    assert read == [frame.t_ns for frame in frames(len(read))]
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()], validate_crcs=True)
        times = [m.message.log_time for m in reader.iter_decoded_messages(topics=[topics.DEPTH])]
    assert times == read


@pytest.mark.parametrize("limit_bytes", [400_000, 777_777, 1_000_000])
def test_a_file_that_may_not_grow(tmp_path: Path, limit_bytes: int) -> None:
    found = record(tmp_path / "a.mcap", limit_bytes)
    check(tmp_path / "a.mcap", found, "File too large")
    assert (tmp_path / "a.mcap").stat().st_size <= limit_bytes


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of one megabyte."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=1m", "none", str(folder)]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("a small file system cannot be mounted here (needs root)")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


def test_a_full_disk(small_disk: Path) -> None:
    found = record(small_disk / "a.mcap", 0)
    check(small_disk / "a.mcap", found, "No space left on device")
