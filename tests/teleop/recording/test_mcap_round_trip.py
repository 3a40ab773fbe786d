"""What is written is read back: by our reader, and by the independent ``mcap`` package with protobuf decoding."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from recording_frames import PERIOD_NS, camera, frames
from scipy.spatial.transform import Rotation

from robot_sim.commands import Liquid
from robot_sim.state import RobotState
from teleop.config.recording import RecordingConfig
from teleop.errors import RecordingError
from teleop.frames import Camera, DepthFrame, Intrinsics
from teleop.intent_types import Event
from teleop.joints import JOINT_INDEX
from teleop.recording import McapSource, McapWriter, topics
from teleop.recording.messages import color_pose
from teleop.recording.writer import MAX_T_NS
from teleop.skeleton import Skeleton

URDF = (
    "<robot name='r'><link name='chassis'/><link name='arm'/>"
    "<joint name='j' type='revolute'><parent link='chassis'/><child link='arm'/></joint></robot>"
)


def robot_state() -> RobotState:
    return RobotState(0.5, 1.0, 2.0, np.pi / 2, 0.1, 0.0, {"j": 0.25}, {}, True, False, False, Liquid.WATER, False)


@settings(max_examples=40)
@given(
    depth=st.tuples(st.integers(1, 40), st.integers(1, 40)).flatmap(
        lambda shape: hnp.arrays(np.uint16, (3, *shape), elements=st.integers(0, 65535))
    ),
    times=st.lists(st.integers(0, MAX_T_NS - 1), min_size=3, max_size=3, unique=True),
    mirrored=st.booleans(),
)
def test_depth_times_and_camera_are_bit_equal(depth: np.ndarray, times: list[int], mirrored: bool) -> None:
    cam = Camera(Intrinsics(100.5, 101.25, 1.0 / 3.0, 7.7, depth.shape[2], depth.shape[1]), mirrored)
    given_frames = [DepthFrame(t, d, cam) for t, d in zip(sorted(times), depth, strict=True)]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.mcap"
        with McapWriter(path, cam, source_uri="virtual:") as writer:
            for frame in given_frames:
                writer.write_frame(frame)
        source = McapSource(path)
        assert source.info.camera == cam
        for frame, read in zip(given_frames, source.frames(), strict=True):
            assert read.t_ns == frame.t_ns
            np.testing.assert_array_equal(read.depth_mm, frame.depth_mm)
        source.close()


def test_colour_registered_or_with_its_own_camera(tmp_path: Path) -> None:
    transform = ((1.0, 0.0, 0.0, 0.025), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    own = Camera(camera().depth, color=Intrinsics(50.0, 50.0, 30.0, 20.0, 64, 48), T_color_depth=transform)
    for name, cam in (("registered", camera()), ("own", own)):
        path = tmp_path / f"{name}.mcap"
        written = frames(4, cam=cam, color=True)
        with McapWriter(path, cam, source_uri="x") as writer:
            for frame in written:
                writer.write_frame(frame)
        source = McapSource(path)
        assert source.info.camera == cam
        assert source.info.has_color
        for frame, read in zip(written, source.frames(), strict=True):
            assert read.color_rgb is not None and frame.color_rgb is not None
            difference = np.abs(read.color_rgb.astype(int) - frame.color_rgb)
            assert difference.mean() < 3.0  # JPEG
            assert not read.color_rgb.flags.writeable
            assert not read.depth_mm.flags.writeable


def test_colour_can_be_left_out(tmp_path: Path) -> None:
    config = RecordingConfig(color=False)
    with McapWriter(tmp_path / "a.mcap", camera(), source_uri="x", config=config) as writer:
        for frame in frames(3, color=True):
            writer.write_frame(frame)
    source = McapSource(tmp_path / "a.mcap")
    assert source.metadata["color_kept"] == "no"
    assert not source.info.has_color
    assert topics.COLOR not in source.file.topics
    assert all(frame.color_rgb is None for frame in source.frames())


def test_seek_gives_the_same_frames_as_reading_through(tmp_path: Path) -> None:
    written = frames(90)
    with McapWriter(tmp_path / "a.mcap", camera(), source_uri="x") as writer:
        for frame in written:
            writer.write_frame(frame)
    source = McapSource(tmp_path / "a.mcap")
    assert source.info.frame_count == 90
    assert source.info.duration_s == pytest.approx(89 * PERIOD_NS * 1e-9)
    for start in (0, 1, 44, 89):
        read = list(source.frames(start * PERIOD_NS * 1e-9))
        assert [f.t_ns for f in read] == [f.t_ns for f in written[start:]]
        np.testing.assert_array_equal(read[0].depth_mm, written[start].depth_mm)
    assert list(source.frames(1000.0)) == []


def test_the_mcap_package_decodes_every_topic(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    written = frames(40, color=True)
    joints = np.full((20, 3), np.nan)
    joints[JOINT_INDEX["head"]] = (0.3, 0.5, 2.0)
    with McapWriter(path, camera(), source_uri="virtual:", urdf=URDF, metadata={"seed": "7"}) as writer:
        for frame in written:
            writer.write_frame(frame)
            writer.write_row(frame.t_ns, {"t": frame.t_s, "joints": {"head": None}})
            writer.write_skeleton(frame.t_ns, Skeleton(frame.t_ns, joints, np.ones(20)))
            writer.write_robot(frame.t_ns, robot_state())
        writer.write_skeleton(written[-1].t_ns, None)
        writer.write_event(Event(written[3].t_ns, "stop", "stop.estop", "key"))
        writer.write_input(written[4].t_ns, {"engage": True})

    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()], validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None
        schemas = {c.topic: summary.schemas[c.schema_id].name for c in summary.channels.values()}
        metadata = {m.name: m.metadata for m in reader.iter_metadata()}
        protobuf = [
            topics.DEPTH,
            topics.DEPTH_INFO,
            topics.COLOR,
            topics.SKELETON,
            topics.JOINT_STATES,
            topics.TF,
            topics.TF_STATIC,
        ]
        messages: dict[str, list] = {}
        for _schema, channel, message, decoded in reader.iter_decoded_messages(topics=protobuf):
            messages.setdefault(channel.topic, []).append((message.log_time, decoded))
        plain: dict[str, list] = {}
        for _schema, channel, message in reader.iter_messages():
            if channel.message_encoding == "json":
                plain.setdefault(channel.topic, []).append(json.loads(message.data))

    assert schemas == {
        "/camera/depth/image_raw": "foxglove.RawImage",
        "/camera/depth/camera_info": "foxglove.CameraCalibration",
        "/camera/color/image_raw/compressed": "foxglove.CompressedImage",
        "/camera/color/camera_info": "foxglove.CameraCalibration",
        "/joint_states": "foxglove.JointStates",
        "/tf": "foxglove.FrameTransforms",
        "/tf_static": "foxglove.FrameTransforms",
        "/robot_description": "std_msgs/String",
        "/teleop/skeleton": "foxglove.SceneUpdate",
        "/teleop/track": "teleop.Track",
        "/teleop/events": "teleop.Event",
        "/teleop/inputs": "teleop.Input",
    }
    teleop = metadata["teleop"]
    assert (teleop["format_version"], teleop["source"], teleop["seed"]) == ("2", "virtual:", "7")
    assert json.loads(teleop["camera"])["depth"]["fx"] == 57.1 and teleop["color_kept"] == "yes"
    assert teleop["software_version"]

    for (t_ns, image), frame in zip(messages[topics.DEPTH], written, strict=True):
        assert t_ns == frame.t_ns == image.timestamp.seconds * 10**9 + image.timestamp.nanos
        assert (image.encoding, image.width, image.height, image.step) == ("16UC1", 64, 48, 128)
        assert image.data == frame.depth_mm.astype("<u2").tobytes()
    for entries in messages.values():
        stamps = [t for t, _ in entries]
        assert stamps == sorted(stamps)

    k = messages[topics.DEPTH_INFO][0][1]
    assert list(k.K) == [57.1, 0, 31.9, 0, 57.2, 23.8, 0, 0, 1]
    assert list(k.P) == [57.1, 0, 31.9, 0, 0, 57.2, 23.8, 0, 0, 0, 1, 0]
    assert messages[topics.JOINT_STATES][0][1].joints[0].name == "j"
    transform = messages[topics.TF][0][1].transforms[0]
    assert (transform.parent_frame_id, transform.child_frame_id) == ("world", "chassis")
    assert transform.rotation.z == pytest.approx(np.sin(np.pi / 4))
    beside = messages[topics.TF_STATIC][0][1].transforms[0]
    assert (beside.parent_frame_id, beside.child_frame_id) == (topics.DEPTH_FRAME, topics.COLOR_FRAME)
    head = messages[topics.SKELETON][0][1].entities[0].spheres[0].pose.position
    # Unmirrored: the operator's right is the left of the image, so x changes sign.
    assert (head.x, head.y, head.z) == (-0.3, -0.5, 2.0)
    assert messages[topics.SKELETON][-1][1].deletions[0].id == "operator"
    assert plain[topics.ROBOT_DESCRIPTION] == [{"data": URDF}]
    assert plain[topics.EVENTS][0]["reason"] == "stop.estop"
    assert plain[topics.INPUTS] == [{"engage": True}]
    assert len(plain[topics.TRACK]) == 40


def test_rows_and_urdf_come_back(tmp_path: Path) -> None:
    with McapWriter(tmp_path / "a.mcap", camera(), source_uri="x", urdf=URDF) as writer:
        for frame in frames(30):
            writer.write_frame(frame)
            writer.write_row(frame.t_ns, {"t": frame.t_s})
    source = McapSource(tmp_path / "a.mcap")
    rows = list(source.rows(topics.TRACK, from_s=0.5))
    assert [t for t, _ in rows] == [f.t_ns for f in frames(30) if f.t_ns >= 1_500_000_000]
    assert rows[0][1]["t"] == pytest.approx(rows[0][0] * 1e-9)
    assert list(source.rows(topics.EVENTS)) == []
    assert source.urdf() == URDF


@pytest.mark.parametrize(
    ("use", "words"),
    [
        (lambda w: w.write_frame(frames(1, cam=camera(32, 24))[0]), "camera changed"),
        (lambda w: [w.write_frame(f) for f in reversed(frames(2))], "must increase"),
        (lambda w: w.write_row(5, {"x": float("nan")}), "null for no answer"),
        (lambda w: w.write_row(5, {"x": object()}), "not plain JSON"),
        (lambda w: w.write_input(-5, {}), "from 0 to"),
        (lambda w: (w.close(), w.write_input(5, {})), "closed already"),
    ],
)
def test_wrong_calls_are_refused(tmp_path: Path, use: object, words: str) -> None:
    with (
        McapWriter(tmp_path / "a.mcap", camera(), source_uri="x") as writer,
        pytest.raises(RecordingError, match=words),
    ):
        use(writer)  # type: ignore[operator]


def test_opening_for_writing_can_fail(tmp_path: Path) -> None:
    (tmp_path / "there.mcap").write_bytes(b"mine")
    with pytest.raises(RecordingError, match="exists already"):
        McapWriter(tmp_path / "there.mcap", camera(), source_uri="x")
    assert (tmp_path / "there.mcap").read_bytes() == b"mine"
    with pytest.raises(RecordingError, match="cannot create"):
        McapWriter(tmp_path / "nowhere" / "a.mcap", camera(), source_uri="x")
    with pytest.raises(RecordingError, match="well-formed"):
        McapWriter(tmp_path / "b.mcap", camera(), source_uri="x", urdf="<robot")
    with pytest.raises(RecordingError, match="camera"):
        McapWriter(tmp_path / "c.mcap", camera(), source_uri="x", metadata={"camera": "no"})
    assert not (tmp_path / "b.mcap").exists()


def test_the_colour_camera_is_placed_where_its_points_come_from() -> None:
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    T_color_depth = np.eye(4)
    T_color_depth[:3, :3], T_color_depth[:3, 3] = turn, (0.025, 0.0, 0.003)
    place, turned = color_pose(Camera(T_color_depth=tuple(map(tuple, T_color_depth.tolist()))))
    T_depth_color = np.eye(4)
    T_depth_color[:3, :3] = Rotation.from_quat(turned).as_matrix()
    T_depth_color[:3, 3] = place
    np.testing.assert_allclose(T_color_depth @ T_depth_color, np.eye(4), atol=1e-12)
