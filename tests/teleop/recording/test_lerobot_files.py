"""LeRobot dataset files, read back with pyarrow and OpenCV; the bench opens them with lerobot itself."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from teleop.errors import RecordingError
from teleop.frames import Camera, DepthFrame, Intrinsics
from teleop.joints import JOINT_NAMES
from teleop.recording.lerobot_features import ACTION, ACTION_NAMES, COLOR, CONFIDENCE, DEPTH, STATE, TIME, Vectors
from teleop.recording.lerobot_writer import LeRobotWriter
from teleop.recording.recorded import RecordedPose

parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed: extra 'datasets'")
CAMERA = Camera(Intrinsics(80.0, 80.0, 31.5, 23.5, 64, 48))
LENGTHS = (70, 5)


def row(command: dict[str, object]) -> dict[str, object]:
    return {
        "joints": dict.fromkeys(JOINT_NAMES) | {"head": [0.1, 0.5, 2.0]},
        "confidence": dict.fromkeys(JOINT_NAMES, 0.0) | {"head": 0.9},
        "angles": {"T1": 4.5},
        "command": command,
    }


def frame(number: int) -> DepthFrame:
    rng = np.random.default_rng(number)
    depth = rng.integers(0, 65536, (48, 64)).astype(np.uint16)
    color = np.full((48, 64, 3), (10 + number, 200, 30), np.uint8)
    return DepthFrame(1_000_000_000 + number * 33_400_000, depth, CAMERA, color, number)


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("lerobot") / "set.lerobot"
    vectors = Vectors(("lift", "disc"))
    writer = LeRobotWriter(folder, 30, "pick tomatoes", vectors.names())
    number = 0
    for length in LENGTHS:
        for i in range(length):
            pose = RecordedPose(0.5, 0.25, 0.0, 1.0, {"lift": 0.01 * number, "disc": -1.0})
            told = {"lift_m": 0.3, "spray_on": True} if i == 0 else {"spray_on": False}
            writer.write(frame(number), vectors.of(row(told), pose))
            number += 1
        writer.end_episode()
    writer.close()
    return folder


def test_the_layout_is_that_of_version_3(dataset: Path) -> None:
    info = json.loads((dataset / "meta" / "info.json").read_text())
    assert (info["codebase_version"], info["fps"]) == ("v3.0", 30)
    assert (info["total_episodes"], info["total_frames"], info["total_tasks"]) == (2, sum(LENGTHS), 1)
    assert info["features"][DEPTH]["shape"] == [48, 64, 1] and info["features"][COLOR]["dtype"] == "video"
    assert info["features"][STATE]["names"] == ["lift", "disc", "base_x_m", "base_y_m", "base_yaw_rad"]
    episodes = parquet.read_table(dataset / "meta" / "episodes" / "chunk-000" / "file-000.parquet").to_pylist()
    assert [(e["length"], e["dataset_from_index"], e["dataset_to_index"]) for e in episodes] == [
        (70, 0, 70),
        (5, 70, 75),
    ]
    for episode in episodes:
        place = {"chunk_index": 0, "file_index": episode["data/file_index"]}
        data = parquet.read_table(dataset / info["data_path"].format(**place))
        assert data.num_rows == episode["length"]
        film = cv2.VideoCapture(str(dataset / info["video_path"].format(video_key=COLOR, **place)))
        assert film.get(cv2.CAP_PROP_FRAME_COUNT) == episode["length"]
        film.release()
    tasks = parquet.read_table(dataset / "meta" / "tasks.parquet")
    assert tasks.column("__index_level_0__").to_pylist() == ["pick tomatoes"]
    assert json.loads(tasks.schema.metadata[b"pandas"])["index_columns"] == ["__index_level_0__"]


def test_depth_and_times_are_kept_bit_for_bit(dataset: Path) -> None:
    rows = [
        r
        for name in ("000", "001")
        for r in parquet.read_table(dataset / f"data/chunk-000/file-{name}.parquet").to_pylist()
    ]
    assert [r["index"] for r in rows] == list(range(75)) and rows[70]["frame_index"] == 0
    for number, found in enumerate(rows):
        depth = cv2.imdecode(np.frombuffer(found[DEPTH]["bytes"], np.uint8), cv2.IMREAD_UNCHANGED)
        assert depth.dtype == np.uint16
        np.testing.assert_array_equal(depth, frame(number).depth_mm)
        assert found[TIME] == frame(number).t_ns
        assert found["timestamp"] == pytest.approx(found["frame_index"] / 30)


def test_what_is_not_known_keeps_its_last_value(dataset: Path) -> None:
    rows = parquet.read_table(dataset / "data/chunk-000/file-000.parquet").to_pylist()
    lift, spray = ACTION_NAMES.index("lift_m"), ACTION_NAMES.index("spray_on")
    assert rows[0][ACTION][lift] == rows[60][ACTION][lift] == pytest.approx(0.3)
    assert (rows[0][ACTION][spray], rows[1][ACTION][spray]) == (1.0, 0.0)
    assert rows[3][CONFIDENCE][JOINT_NAMES.index("head")] == pytest.approx(0.9) and sum(rows[3][CONFIDENCE]) < 1.0


def test_statistics_are_those_of_the_numbers(dataset: Path) -> None:
    stats = json.loads((dataset / "meta" / "stats.json").read_text())
    lift = np.array([0.01 * n for n in range(75)], np.float32)
    assert stats[STATE]["mean"][0] == pytest.approx(lift.mean()) and stats[STATE]["std"][0] == pytest.approx(lift.std())
    assert stats[STATE]["count"] == [75] and stats["frame_index"]["max"] == [69.0]
    assert np.shape(stats[COLOR]["mean"]) == (3, 1, 1) and stats[COLOR]["max"][1] == [[pytest.approx(200 / 255)]]
    assert stats[DEPTH]["max"][0][0][0] <= 65535.0


def test_a_dataset_without_frames_or_in_an_old_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="at least one"):
        LeRobotWriter(tmp_path / "a", 30, "t", {}).close()
    with pytest.raises(RecordingError, match="cannot write"):
        LeRobotWriter(tmp_path / "a", 30, "t", {})
