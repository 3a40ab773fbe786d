"""The study of ten operators: their starts, its figures, and what an operator may see."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from robot_sim.env import GreenhouseEnv
from teleop.data import data_root
from teleop.intent_types import Mode
from teleop.operator_model.traits import traits_of
from teleop.studies.task_times import figures_of
from teleop.studies.trials import FRAMES_PER_S, OFF_M, Trial, TrialSpec, beats, started

DONE = Trial("pick", 0, True, 5.0, "", 0.1, 0.02, 1, {}, 0.0, 0.0, 0.0, 0, 0, 1.0)


def test_only_successes_are_timed_and_every_trial_counts() -> None:
    trials = [
        DONE,
        replace(DONE, tester=1, time_s=7.0),
        replace(DONE, tester=2, time_s=20.0, success=False, why="a fruit fell on the floor"),
        replace(DONE, task="spray", time_s=60.0),
    ]
    figures = figures_of(trials, "pick")
    assert (figures.tried, figures.succeeded) == (3, 2)
    assert (figures.mean_s, figures.spread_s, figures.longest_s) == pytest.approx((6.0, 1.0, 7.0))
    assert np.isnan(figures_of(trials[2:3], "pick").mean_s)


def test_every_start_needs_a_correction_of_the_chassis_and_a_pick_is_off_the_steps() -> None:
    for tester in range(10):
        pick, spray = (started(TrialSpec(task, tester, 0, 320, 240)).start for task in ("pick", "spray"))
        assert all(OFF_M[0] <= start.off_m <= OFF_M[1] for start in (pick, spray))
        # the hand of an arm half raised moves 3.6 mm a degree, half a step is 27 mm
        assert 0.018 <= abs(pick.lift_off_m) <= 0.034 and spray.lift_off_m == 0.0


@pytest.mark.data
def test_the_operator_acts_late_and_through_images_alone() -> None:
    root = data_root()
    if root is None or not (root / "makehuman").is_dir():
        pytest.skip("needs the data set makehuman (TELEOP_DATA)")
    spec, traits = TrialSpec("pick", 4, 0, 320, 240), traits_of(4, 0)
    with GreenhouseEnv(started(spec), period_s=1.0 / FRAMES_PER_S) as env:
        shown = list(islice(beats(spec, env, traits), 75))
    before, after = [b for b in shown if b.t_s < -1e-9], [b for b in shown if b.t_s >= -1e-9]
    assert before[-1].output.intent.mode is Mode.PICKING, "engaged, arms down, before the word go"
    assert max(abs(b.robot.base_x_m - before[0].robot.base_x_m) for b in before) < 0.002
    acting = next(b.t_s for b in after if b.mind.stage != "look")
    driving = next(b.t_s for b in after if b.output.command.drive_m_s > 0.0)
    assert acting >= traits.reaction_s - 1e-9 and driving > acting
