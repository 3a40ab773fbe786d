"""The real Kinect recordings: the share of trusted upper-body joints near the other tracker's must not fall."""

import pytest

from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config.body import BodyConfig
from teleop.data import data_root
from teleop.evaluation.answers import run_tracker, single_frame
from teleop.evaluation.overall import joint_table
from teleop.evaluation.recorded import real_cases, real_table

pytestmark = pytest.mark.data


@pytest.mark.skipif(
    data_root() is None or not (data_root() / "kinect_real").is_dir(), reason="data set kinect_real is not here"
)
def test_trusted_upper_body_joints_within_10_cm() -> None:
    tracker = BodyTracker(load_model(), single_frame(BodyConfig()))
    answers = run_tracker(tracker, real_cases(every=12), single=True)
    text, figures = real_table(answers)
    assert figures["real.subject_1"] > 0.85
    assert figures["real.subject_3"] > 0.85
    assert answers.found.mean() > 0.95
    assert "subject 3" in text
    assert joint_table(answers).count("\n") >= 20
