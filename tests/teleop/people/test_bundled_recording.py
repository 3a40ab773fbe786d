"""The recording that comes with the project, read as a user reads it, against the truth beside it."""

import json
from pathlib import Path

import numpy as np
import pytest

from teleop.data import data_root
from teleop.frames import pixels
from teleop.joints import JOINT_INDEX
from teleop.recording import McapSource
from teleop.sources.virtual import open_virtual

PATH = Path(__file__).parents[3] / "recordings" / "greenhouse_demo.mcap"


@pytest.fixture(scope="module")
def rows():
    return [json.loads(line) for line in PATH.with_suffix(".truth.jsonl").read_text().splitlines()]


@pytest.fixture
def source():
    opened = McapSource(PATH)
    yield opened
    opened.close()


def test_it_is_as_long_and_as_small_as_promised(source):
    assert 35 <= source.info.duration_s <= 45
    assert PATH.stat().st_size <= 40e6
    assert source.info.has_color


def test_every_frame_has_its_truth(source, rows):
    assert source.info.frame_count == len(rows)
    times = [frame.t_s for frame in source.frames(source.info.duration_s - 3.0)]
    assert np.allclose(times, [row["t"] for row in rows[-len(times) :]], atol=1e-6)


def test_the_person_is_where_the_truth_says(source, rows):
    checked = 0
    for at_s in (5.0, 8.5, 12.5, 15.5, 21.0, 30.0):
        frame = next(iter(source.frames(at_s)))
        row = rows[frame.seq] if rows[frame.seq]["t"] == pytest.approx(frame.t_s) else None
        row = row or min(rows, key=lambda r: abs(r["t"] - frame.t_s))
        for name in ("head", "spine", "shoulder_right", "shoulder_left"):
            p = np.array(row["joints"][name])
            u, v = np.rint(pixels(p, frame.camera)).astype(int)
            if not (2 <= u < frame.camera.depth.width - 2 and 2 <= v < frame.camera.depth.height - 2):
                continue
            window = frame.depth_mm[v - 2 : v + 3, u - 2 : u + 3]
            assert p[2] - 0.25 < np.median(window[window > 0]) / 1000 < p[2] + 0.03, (at_s, name)
            checked += 1
    assert checked >= 20


def test_the_truth_names_twenty_joints(rows):
    assert all(set(row["joints"]) == set(JOINT_INDEX) for row in rows if row["joints"])


@pytest.mark.data
@pytest.mark.skipif(
    data_root() is None or not (data_root() / "makehuman").is_dir(), reason="the MakeHuman files are not here"
)
def test_it_is_what_its_command_renders(source):
    performance = open_virtual("makehuman,seed=1,size=320x240,fps=20").performance
    for number in (100, 500):
        recorded = next(iter(source.frames(number / 20)))
        same = recorded.depth_mm == performance.take(number).frame.depth_mm
        # Another processor may round a few pixels to the next disparity step.
        assert same.mean() > 0.99
