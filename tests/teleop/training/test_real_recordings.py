"""The real Kinect recordings: the share of trusted upper-body joints near the other tracker's must not fall."""

import numpy as np
import pytest

from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config.body import BodyConfig
from teleop.data import data_root
from teleop.training.evaluation import real, run_tracker, single_frame
from teleop.training.real import UPPER_BODY
from teleop.training.report import figures_of, joint_table, near_share

pytestmark = pytest.mark.data


@pytest.mark.skipif(
    data_root() is None or not (data_root() / "kinect_real").is_dir(), reason="data set kinect_real is not here"
)
def test_trusted_upper_body_joints_within_10_cm() -> None:
    tracker = BodyTracker(load_model(), single_frame(BodyConfig()))
    answers = run_tracker(tracker, real(every=12), lambda: None)
    for subject in (1, 3):
        assert near_share(figures_of(answers.of_group(subject)), UPPER_BODY) > 0.85
    assert (answers.area_px > 0).mean() > 0.95
    assert np.isfinite(answers.seconds).all()
    assert joint_table(answers).count("\n") >= 20
