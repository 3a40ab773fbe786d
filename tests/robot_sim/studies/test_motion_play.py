"""A study's motion read back from its file and drawn by PyBullet."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from robot_sim.arms.tomato import tomato_arm
from robot_sim.arms.urdf_writer import ArmModel, limbs_of, write_urdf
from robot_sim.errors import RobotError
from robot_sim.kinematics.transforms import rot_x, rot_z, rpy, translation
from robot_sim.planner.shapes import Box, Cylinder, sphere
from robot_sim.studies.motion_file import write_motion
from robot_sim.studies.motion_read import StoredMotion, read_motion
from robot_sim.studies.picture_files import write_frames, write_video
from robot_sim.studies.player import frame_times, pictures

ARM = tomato_arm().chain
T_S = np.linspace(0.0, 0.4, 5)
Q = np.linspace(0.0, 1.0, 5)[:, None] * np.array([0.5, 0.4, -0.3, 0.6, 0.2])
TURNED = translation(0.5, 0.2, 0.1) @ rot_z(0.4) @ rot_x(0.3)
SOLIDS = (
    (Box(TURNED, (0.05, 0.10, 0.15)), (1.0, 0.0, 0.0, 1.0)),
    (Cylinder(translation(0.3, -0.4, 0.6), 0.1, 0.4), (0.0, 1.0, 0.0, 0.3)),
    (sphere((0.1, 0.6, 0.2), 0.07), (0.0, 0.0, 1.0, 1.0)),
)


def make(path: Path) -> Path:
    urdf = write_urdf(ArmModel(ARM, limbs_of(ARM, 0.03), ()))
    return write_motion(path, urdf, ARM, T_S, Q, solids=SOLIDS, about={"study": "test"})


@pytest.fixture(scope="module")
def motion(tmp_path_factory: pytest.TempPathFactory) -> StoredMotion:
    return read_motion(make(tmp_path_factory.mktemp("motion") / "motion.mcap"))


def test_what_was_written_is_read_back(motion: StoredMotion) -> None:
    assert motion.joint_names == tuple(j.name for j in ARM.joints)
    np.testing.assert_allclose(motion.t_s, T_S, atol=1e-9)
    np.testing.assert_allclose(motion.q, Q, atol=1e-12)
    np.testing.assert_allclose(motion.path_m, ARM.forward(Q)[:, :3, 3], atol=1e-9)
    assert motion.about["study"] == "test"
    assert list(motion.at(0.15).values()) == pytest.approx(Q[1:3].mean(axis=0))
    by_kind = {p.kind: p for p in motion.volumes}
    assert by_kind["box"].size_m == pytest.approx((0.1, 0.2, 0.3))
    assert by_kind["cylinder"].size_m == pytest.approx((0.1, 0.4)) and by_kind["cylinder"].rgba[3] == 0.3
    assert by_kind["sphere"].size_m == pytest.approx((0.07,))
    np.testing.assert_allclose(rpy(*by_kind["box"].rpy_rad)[:3, :3], TURNED[:3, :3], atol=1e-9)


def test_pictures_show_a_moving_arm_before_standing_volumes(motion: StoredMotion) -> None:
    images = list(pictures(motion, 5.0, (160, 120)))
    assert len(images) == len(frame_times(motion, 5.0)) == 3
    first, last = images[0].astype(int), images[-1].astype(int)
    assert (np.abs(first - last).max(axis=2) > 40).sum() > 50  # the arm moved
    red = (first[:, :, 0] > 100) & (first[:, :, 1] < 60) & (first[:, :, 2] < 60)
    blue = (first[:, :, 2] > 120) & (first[:, :, 0] < 90)
    assert red.sum() > 10 and blue.sum() > 10  # box; sphere and path


def test_pictures_become_a_video_and_files(motion: StoredMotion, tmp_path: Path) -> None:
    ticks: list[int] = []
    assert write_video(pictures(motion, 5.0, (160, 120)), tmp_path / "m.mp4", 5.0, lambda: ticks.append(1)) == 3
    video = cv2.VideoCapture(str(tmp_path / "m.mp4"))
    assert (video.get(cv2.CAP_PROP_FRAME_COUNT), video.get(cv2.CAP_PROP_FRAME_WIDTH)) == (3, 160)
    video.release()
    assert write_frames(pictures(motion, 5.0, (160, 120)), tmp_path / "f", lambda: ticks.append(1)) == 3
    assert len(list((tmp_path / "f").glob("*.png"))) == 3 and len(ticks) == 6


def test_what_is_no_motion_is_named(motion: StoredMotion, tmp_path: Path) -> None:
    with pytest.raises(RobotError, match="no motion at"):
        read_motion(tmp_path / "none.mcap")
    (tmp_path / "text.mcap").write_text("not a motion")
    with pytest.raises(RobotError, match="damaged or no MCAP"):
        read_motion(tmp_path / "text.mcap")
    cut = make(tmp_path / "cut.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(cut[: len(cut) // 2])
    with pytest.raises(RobotError, match="damaged or no MCAP"):
        read_motion(tmp_path / "cut.mcap")
    with pytest.raises(RobotError, match="cannot read"):
        read_motion(tmp_path)
    with pytest.raises(RobotError, match="no folder"):
        write_video(iter(()), tmp_path / "none" / "m.mp4", 5.0, lambda: None)
    with pytest.raises(RobotError, match="positive"):
        frame_times(motion, 0.0)
