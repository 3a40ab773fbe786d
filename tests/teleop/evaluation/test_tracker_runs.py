"""Measuring a tracker: answers, times by stage, the report; with the shipped model on a few rendered frames."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from teleop.body import tracker as tracker_module
from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config import TeleopConfig
from teleop.data import data_root
from teleop.errors import DataError
from teleop.evaluation import testers as protocol
from teleop.evaluation.answers import run_tracker, single_frame
from teleop.evaluation.cases import Case
from teleop.evaluation.memory import peak_memory_mb
from teleop.evaluation.motions import FreeMotion
from teleop.evaluation.nobody import Nobody
from teleop.evaluation.overall import joint_table
from teleop.evaluation.section import Bench, Section
from teleop.evaluation.speed import stage_seconds, step_seconds
from teleop.evaluation.stages import StageClock
from teleop.evaluation.store import FrameStore
from teleop.evaluation.suite import Report
from teleop.evaluation.targets import TARGETS, target_table

needs_people = pytest.mark.skipif(
    data_root() is None or not (data_root() / "makehuman").is_dir(), reason="the MakeHuman files are not here"
)


@pytest.fixture(scope="module")
def smooth() -> BodyTracker:
    return BodyTracker(load_model(), TeleopConfig().body)


@pytest.fixture(scope="module")
def moving() -> list[Case]:
    return FreeMotion(frames=12, width=320, height=240).batch(0)


@needs_people
@pytest.mark.data
def test_single_frames_do_not_know_each_other(smooth: BodyTracker, moving: list[Case]) -> None:
    single = BodyTracker(smooth.model, single_frame(smooth.config))
    forth = run_tracker(single, moving, single=True)
    back = run_tracker(single, moving[::-1], single=True)
    np.testing.assert_array_equal(forth.joints_m, back.joints_m[::-1])
    assert forth.found.all()
    assert forth.confusion.sum() > 1000
    assert joint_table(forth).count("\n") == 22


@needs_people
@pytest.mark.data
def test_a_new_group_begins_anew(smooth: BodyTracker, moving: list[Case]) -> None:
    other = [replace(c, group=99) for c in moving]
    both = run_tracker(smooth, moving + other, single=False)
    np.testing.assert_array_equal(both.of_group(99).joints_m, both.of_group(moving[0].group).joints_m)


@needs_people
@pytest.mark.data
def test_stages_add_up_to_the_step_and_leave_the_tracker_as_it_was(smooth: BodyTracker, moving: list[Case]) -> None:
    frames = [c.frame for c in moving[:5]]
    look = tracker_module.look
    stages = stage_seconds(smooth, [frames])
    assert tracker_module.look is look
    assert {"segmentation", "forest", "votes"} <= set(stages)
    assert all(len(s) == 5 and (s >= 0).all() for s in stages.values())
    seconds, area = step_seconds(smooth, [frames])
    assert len(seconds) == 5 and min(area) > 1000


def test_a_stage_is_timed_without_what_it_calls() -> None:
    clock = StageClock()
    inner = clock.wrap("inner", lambda: sum(range(200_000)))
    outer = clock.wrap("outer", lambda: inner() and inner())
    outer()
    lap = clock.lap()
    assert lap["outer"] < lap["inner"]
    assert clock.lap() == {}


def test_empty_rooms_hold_nobody(smooth: BodyTracker) -> None:
    answers = run_tracker(smooth, Nobody(width=320, height=240).batch(0), single=True)
    assert not answers.found.any()
    assert np.isnan(answers.joints_m).all()


def test_sections_say_when_data_are_missing(
    smooth: BodyTracker, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("TELEOP_DATA", str(tmp_path / "nothing"))
    bench = Bench(smooth, smooth, TeleopConfig(), FrameStore(None), 10, lambda name, share: None)
    with pytest.raises(DataError, match="makehuman"):
        protocol.testers_section(bench)


def test_the_report_is_written(tmp_path: Path) -> None:
    section = Section("Speed", "text", {"speed.median_ms": 4.0, "bins.right": 0.99})
    report = Report((section,), {"real": "data set 'kinect_real' not found"})
    path = report.write(tmp_path / "new", "Made by a test.", plots=False)
    text = path.read_text()
    assert "## Speed" in text and "kinect_real" in text
    assert (tmp_path / "new" / "figures.json").is_file()
    rows = target_table(report.figures).splitlines()[2:]
    assert [row.rsplit("| ", 1)[1] for row in rows] == ["least |", "least |"]


def test_every_target_can_be_missed() -> None:
    for t in TARGETS:
        worse = t.least - 1 if t.higher_is_better else t.least + 1
        assert t.verdict(worse) == "missed"
        assert t.verdict(t.least) in ("least", "aim")
        assert t.verdict(t.aim) == "aim"


def test_peak_memory_of_a_program() -> None:
    import sys

    small = peak_memory_mb([sys.executable, "-c", "pass"])
    large = peak_memory_mb([sys.executable, "-c", "x = bytearray(80_000_000); x[::4096] = b'1' * len(x[::4096])"])
    assert 5 < small < 60
    assert 70 < large - small < 95
