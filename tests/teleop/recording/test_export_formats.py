"""Tracking rows as a table and as a film."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from teleop.errors import RecordingError
from teleop.frames import Camera, DepthFrame, Intrinsics, pixels
from teleop.joints import JOINT_NAMES
from teleop.recording.csv_table import csv_columns, csv_values
from teleop.recording.video import VideoWriter, overlay

CAMERA = Camera(Intrinsics(285.0, 285.0, 159.5, 119.5, 320, 240))


def row(t_s: float = 0.5) -> dict[str, object]:
    joints: dict[str, list[float] | None] = dict.fromkeys(JOINT_NAMES)
    joints |= {"head": [0.3, 0.4, 2.0], "shoulder_center": [0.3, 0.1, 2.0]}
    return {
        "t": t_s,
        "joints": joints,
        "confidence": dict.fromkeys(JOINT_NAMES, 0.0) | {"head": 0.9},
        "angles": {"theta1_right": 12.5, "T2": None},
        "hands": {"right": "fist", "left": "unknown"},
        "zone": "work",
        "mode": "engaged",
        "command": {"right_arm": {"c1_deg": 30.0, "c2_deg": 0.0, "elbow_deg": 180.0}, "spray_on": True},
        "reasons": ["hold.one", "limit.two"],
    }


def frame(t_ns: int = 0, color: bool = False) -> DepthFrame:
    image = np.full((120, 160, 3), (200, 10, 10), np.uint8) if color else None
    return DepthFrame(t_ns, np.zeros((240, 320), np.uint16), CAMERA, image)


def test_every_value_stands_under_its_column() -> None:
    values = dict(zip(csv_columns(), csv_values(row()), strict=True))
    assert (values["t_s"], values["head_x_m"], values["head_confidence"]) == (0.5, 0.3, 0.9)
    assert values["elbow_left_x_m"] is None and values["T2_deg"] is None
    assert values["theta1_right_deg"] == 12.5 and values["command_right_arm_c1_deg"] == 30.0
    assert values["command_left_arm_c1_deg"] is None and values["command_spray_on"] == 1
    assert (values["hand_right"], values["zone"], values["reasons"]) == ("fist", "work", "hold.one limit.two")
    assert len(csv_columns()) == len(set(csv_columns()))


@pytest.mark.parametrize("mirrored", [False, True])
def test_the_skeleton_lies_where_the_camera_sees_it(mirrored: bool) -> None:
    camera = Camera(CAMERA.depth, mirrored=mirrored)
    seen = DepthFrame(0, np.zeros((240, 320), np.uint16), camera)
    picture = overlay(seen, row())
    assert picture.shape == (480, 640, 3)
    u, v = 2 * pixels(np.array([0.3, 0.4, 2.0]), camera)
    assert picture[round(v), round(u)].tolist() == [60, 60, 255]
    assert picture[round(v), 640 - round(u)].tolist() == [0, 0, 0], "and not on the other side"


def test_colour_stands_beside_depth() -> None:
    picture = overlay(frame(color=True), row())
    assert picture.shape == (480, 1280, 3)
    assert picture[240, 900].tolist() == [10, 10, 200]


def test_a_film_keeps_the_frames_own_times(tmp_path: Path) -> None:
    video = VideoWriter(tmp_path / "a.mp4", 10.0)
    for t_ms, level in ((0, 20), (100, 20), (900, 220), (60_900, 220)):
        video.write(t_ms * 1_000_000, np.full((48, 64, 3), level, np.uint8))
    video.close()
    film = cv2.VideoCapture(str(tmp_path / "a.mp4"))
    levels = []
    while (read := film.read())[0]:
        levels.append(float(read[1].mean()))
    assert film.get(cv2.CAP_PROP_FPS) == 10.0
    assert len(levels) == 10 + 20, "a minute without frames is cut to two seconds"
    assert [level > 120 for level in levels] == [False] * 9 + [True] * 21, "a picture stays until the next"


def test_a_folder_that_is_not_there_is_one_error(tmp_path: Path) -> None:
    video = VideoWriter(tmp_path / "missing" / "a.mp4", 30.0)
    with pytest.raises(RecordingError, match="cannot write"):
        video.write(0, np.zeros((48, 64, 3), np.uint8))
