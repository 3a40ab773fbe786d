"""Rendered evaluation frames: kept and read back alike, true to what was asked for, deterministic."""

from pathlib import Path

import numpy as np
import pytest

from teleop.body.parts import NO_PART
from teleop.config.intent import AngleConfig
from teleop.data import data_root
from teleop.evaluation import stills
from teleop.evaluation import store as store_module
from teleop.evaluation.angle_figures import ANGLES, body_angles_deg
from teleop.evaluation.cases import Case
from teleop.evaluation.motions import FreeMotion
from teleop.evaluation.nobody import KIND_NAMES, Nobody
from teleop.evaluation.stills import Stills
from teleop.evaluation.store import FrameStore
from teleop.joints import JOINT_INDEX

SMALL = {"width": 320, "height": 240}
needs_people = pytest.mark.skipif(
    data_root() is None or not (data_root() / "makehuman").is_dir(), reason="the MakeHuman files are not here"
)


def levelled_angles(cases: list[Case]) -> np.ndarray:
    joints = np.stack([c.joints_m @ c.R_level_camera.T for c in cases])
    return body_angles_deg(joints, np.ones(joints.shape[:2], bool), AngleConfig())


@needs_people
@pytest.mark.data
def test_kept_frames_come_back_as_they_were(tmp_path: Path) -> None:
    kept, frames = FrameStore(tmp_path), FreeMotion(frames=3, color=True, **SMALL)
    calls: list[None] = []
    drawn = list(kept.cases(frames, 1, lambda: calls.append(None)))
    assert len(list(tmp_path.rglob("*.npz"))) == len(calls) == 1
    again = list(kept.cases(frames, 1))
    for a, b in zip(drawn, again, strict=True):
        assert (a.frame.depth_mm == b.frame.depth_mm).all()
        assert (a.frame.color_rgb == b.frame.color_rgb).all()
        assert (a.part == b.part).all()
        assert (a.joints_m == b.joints_m).all() and (a.counted == b.counted).all()
        assert (a.R_level_camera == b.R_level_camera).all()
        assert (a.frame.t_ns, a.frame.camera, a.group) == (b.frame.t_ns, b.frame.camera, b.group)


@needs_people
@pytest.mark.data
def test_the_same_frames_in_every_run_and_other_ones_for_another_setting(tmp_path: Path) -> None:
    a, b = (Stills("legs", levels=(3.0, 22.0), room=False, **SMALL).batch(0) for _ in range(2))
    assert all((x.frame.depth_mm == y.frame.depth_mm).all() for x, y in zip(a, b, strict=True))
    kept = FrameStore(tmp_path)
    paths = {kept.path(s, 0) for s in (Stills(), Stills(mirrored=True), Stills("bins"), FreeMotion())}
    assert len(paths) == 4


@needs_people
@pytest.mark.data
def test_legs_stand_as_far_apart_as_asked() -> None:
    cases = Stills("legs", levels=(3.0, 22.0), room=False, turn_deg=0.0, **SMALL).batch(1)
    T1 = levelled_angles(cases)[:, ANGLES.index("T1")]
    assert np.abs(T1 - [c.level for c in cases]).max() < 4.0
    assert (T1[::2] < 12).all() and (T1[1::2] > 12).all()


@needs_people
@pytest.mark.data
def test_testers_take_the_angles_of_the_experiment() -> None:
    setting = Stills(room=False, turn_deg=0.0, height_m=(1.0, 1.0), tilt_deg=(0.0, 0.0), **SMALL)
    for kind, angle in (("forward", "theta2"), ("sideways", "theta1"), ("elbow_forward", "theta3")):
        cases = stills.Testers(kind, setting).batch(4)
        true = levelled_angles(cases)[:, ANGLES.index(f"{angle}_right")]
        assert np.abs(true - [c.level for c in cases]).max() < 9.0
        assert np.diff(true).min() > 0
    heights = [stills.tester(n).body.height_m for n in (0, 9)]
    assert heights == pytest.approx([1.65, 1.90], abs=1e-6)


@needs_people
@pytest.mark.data
def test_a_mirrored_camera_sees_the_same_person() -> None:
    plain, flipped = (Stills(mirrored=m, room=False, **SMALL).batch(2)[0] for m in (False, True))
    np.testing.assert_allclose(plain.joints_m, flipped.joints_m, atol=1e-9)
    assert (plain.part == JOINT_INDEX["hip_right"]).any() and (flipped.part == JOINT_INDEX["hip_right"]).any()


@needs_people
@pytest.mark.data
def test_lost_pixels_are_lost() -> None:
    whole, holed = (Stills(dropout=share, room=False, **SMALL).batch(3)[0] for share in (0.0, 0.1))
    seen = whole.frame.depth_mm > 0
    assert 0.07 < (holed.frame.depth_mm[seen] == 0).mean() < 0.13
    assert (holed.part[holed.frame.depth_mm == 0] == NO_PART).all()


def test_rooms_without_a_person_have_no_truth_and_every_kind() -> None:
    cases = [Nobody(**SMALL).batch(k)[0] for k in range(len(KIND_NAMES))]
    assert [c.group for c in cases] == list(range(len(KIND_NAMES)))
    assert all((c.frame.depth_mm > 0).mean() > 0.4 for c in cases)
    assert not any(c.counted.any() for c in cases)


def test_many_workers_give_the_frames_in_order(tmp_path: Path) -> None:
    frames = Nobody(**SMALL)
    many = list(FrameStore(tmp_path, workers=2).cases(frames, 2, first=3))
    assert [c.frame.seq for c in many] == list(range(30, 50))
    one = list(FrameStore(None).cases(frames, 2, first=3))
    assert all((a.frame.depth_mm == b.frame.depth_mm).all() for a, b in zip(many, one, strict=True))


def test_changed_drawing_code_means_other_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = FrameStore(tmp_path).path(Nobody(), 0)
    monkeypatch.setattr(store_module, "code_print", lambda sampler: "other code")
    assert FrameStore(tmp_path).path(Nobody(), 0) != before
