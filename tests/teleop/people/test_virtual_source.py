"""``virtual:`` is a real source without any data set: deterministic, seekable, with clear errors."""

import numpy as np
import pytest

from teleop.errors import DataError, SourceError
from teleop.frames import pixels
from teleop.joints import JOINT_INDEX
from teleop.sources.virtual import open_virtual


@pytest.fixture
def no_data(monkeypatch, tmp_path):
    monkeypatch.setenv("TELEOP_DATA", str(tmp_path / "nowhere"))


def first(source, from_s):
    return next(iter(source.frames(from_s)))


def test_it_needs_no_data_set(no_data):
    source = open_virtual("")
    frame = first(source, 8.0)
    assert frame.depth_mm.shape == (240, 320)
    assert frame.color_rgb is not None
    assert frame.t_s == pytest.approx(8.0, abs=0.04)
    assert source.info.frame_count == pytest.approx(source.info.duration_s * 30 + 1)


def test_two_runs_give_the_same_frames(no_data):
    a, b = (first(open_virtual("seed=3,size=160x120"), 10.0) for _ in range(2))
    assert (a.depth_mm == b.depth_mm).all()
    assert (a.color_rgb == b.color_rgb).all()


def test_another_seed_gives_other_frames(no_data):
    a, b = (first(open_virtual(f"seed={s},size=160x120"), 10.0) for s in (3, 4))
    assert (a.depth_mm != b.depth_mm).any()


def test_frames_come_in_order_from_where_they_are_asked(no_data):
    source = open_virtual("fps=10,size=80x60")
    frames = list(source.frames(source.info.duration_s - 1.0))
    assert [f.seq for f in frames] == list(range(source.info.frame_count - 11, source.info.frame_count))
    assert np.allclose(np.diff([f.t_ns for f in frames]), 1e8)


def test_closing_ends_the_frames(no_data):
    source = open_virtual("size=80x60")
    frames = source.frames()
    next(frames)
    source.close()
    source.close()
    assert list(frames) == []


@pytest.mark.parametrize("arg", ["nobody", "size=ten", "fps=0", "size=10x10", "seed=-1"])
def test_a_wrong_argument_is_told(arg):
    with pytest.raises(SourceError, match="virtual:"):
        open_virtual(arg)


def test_makehuman_without_its_files_is_told(no_data):
    with pytest.raises(DataError, match="makehuman"):
        open_virtual("makehuman,seed=917")


def test_the_person_stands_where_the_truth_says(no_data):
    performance = open_virtual("size=320x240").performance
    take = performance.take(int(8.0 * 30))
    for name in ("head", "spine", "shoulder_right", "shoulder_left", "wrist_right", "wrist_left"):
        p = take.joints_m[JOINT_INDEX[name]]
        u, v = np.rint(pixels(p, performance.camera)).astype(int)
        window = take.frame.depth_mm[v - 2 : v + 3, u - 2 : u + 3]
        seen = np.median(window[window > 0]) / 1000
        assert p[2] - 0.25 < seen < p[2] + 0.03, name


def test_more_rounds_go_on_in_time(no_data):
    once, twice = open_virtual("fps=1,size=160x120"), open_virtual("fps=1,size=160x120,rounds=2")
    assert twice.info.frame_count == 2 * once.info.frame_count and "rounds=2" in twice.info.uri
    count = once.info.frame_count
    late = first(twice, count + 10.0)
    assert late.t_ns == (count + 10) * 1_000_000_000 and late.seq == count + 10
    assert (late.depth_mm == first(once, 10.0).depth_mm).all()
    with pytest.raises(SourceError, match="rounds"):
        open_virtual("rounds=0")
