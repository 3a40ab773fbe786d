"""A recorder killed at ten random moments: its file opens at once, lacks a second at most, and is made whole."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from recording_frames import frames

from teleop.recording import McapSource, topics
from teleop.recording.repair import repair, repair_folder

HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def host() -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, str(HERE / "recording_host.py")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as child:
        yield child
        assert child.stdin is not None
        child.stdin.close()


def killed(host: subprocess.Popen[str], path: Path, chance: random.Random) -> int:
    """Record to ``path`` until SIGKILL; the time of the last frame that the recorder surely had."""
    assert host.stdin is not None and host.stdout is not None
    print(path, file=host.stdin, flush=True)
    pid = int(host.stdout.readline())
    times = [int(host.stdout.readline()) for _ in range(chance.randrange(4, 150))]
    time.sleep(chance.uniform(0.0, 0.012))  # anywhere between two frames, or within one
    os.kill(pid, signal.SIGKILL)
    while (line := host.stdout.readline()) != "END\n":
        times.append(int(line))
    return times[-1]


@pytest.mark.parametrize("seed", range(10))
def test_at_most_a_second_is_lost_and_other_readers_open_it(
    host: subprocess.Popen[str], tmp_path: Path, seed: int
) -> None:
    path = tmp_path / "killed.mcap"
    last_ns = killed(host, path, random.Random(seed))
    source = McapSource(path)
    read = list(source.frames())
    rows = [t for t, _ in source.rows(topics.TRACK)]
    assert source.truncated is not None
    source.close()
    assert last_ns - read[-1].t_ns <= 1_000_000_000
    for frame, original in zip(read, frames(len(read)), strict=True):
        assert frame.t_ns == original.t_ns
        np.testing.assert_array_equal(frame.depth_mm, original.depth_mm)

    if seed % 2:
        assert repair(path) > len(read)
    else:  # as the server does when it starts
        assert len(list(repair_folder(tmp_path))) == 1
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()], validate_crcs=True)
        found = list(reader.iter_decoded_messages(topics=[topics.DEPTH]))
        tracked = [m.log_time for _, _, m in reader.iter_messages(topics=[topics.TRACK])]
    assert [m.message.log_time for m in found] == [f.t_ns for f in read]
    assert all(a.message.log_time < b.message.log_time for a, b in pairwise(found))
    assert [m.decoded_message.data for m in found] == [f.depth_mm.tobytes() for f in read]
    assert tracked == rows
