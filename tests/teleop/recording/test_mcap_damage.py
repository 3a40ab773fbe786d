"""Recordings cut off, damaged, or made by others: frames or one clear error, never a hang."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from foxglove import Channel, Context, Schema, open_mcap
from foxglove.channels import CompressedImageChannel, RawImageChannel
from foxglove.mcap import MCAPCompression, MCAPWriteOptions
from foxglove.messages import CompressedImage, RawImage
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from recording_frames import camera, frames

from teleop.errors import RecordingError
from teleop.frames import DepthFrame
from teleop.recording import McapSource, McapWriter, topics
from teleop.recording.repair import repair, repair_folder


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("whole") / "a.mcap"
    with McapWriter(path, camera(), source_uri="x") as writer:
        for frame in frames(60, color=True):
            writer.write_frame(frame)
            writer.write_row(frame.t_ns, {"t": frame.t_s})
    return path.read_bytes()


def read_all(path: Path) -> list[DepthFrame]:
    source = McapSource(path)
    try:
        return list(source.frames())
    finally:
        source.close()


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_cut_anywhere_it_opens_up_to_the_last_complete_chunk(whole: bytes, tmp_path: Path, data: st.DataObject) -> None:
    length = data.draw(st.integers(0, len(whole)))
    path = tmp_path / "cut.mcap"
    path.write_bytes(whole[:length])
    try:
        read = read_all(path)
    except RecordingError as error:
        assert "\n" not in str(error)
        # A chunk holds half a second.
        assert length < len(whole) * 0.35
        return
    originals = frames(60)
    assert len(read) >= 60 * length / len(whole) - 18
    for frame, original in zip(read, originals, strict=False):
        assert frame.t_ns == original.t_ns
        np.testing.assert_array_equal(frame.depth_mm, original.depth_mm)


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_damaged_bytes_give_frames_or_one_error(whole: bytes, tmp_path: Path, data: st.DataObject) -> None:
    damaged = bytearray(whole)
    edits = st.tuples(st.integers(0, len(whole) - 1), st.integers(0, 255))
    for position, value in data.draw(st.lists(edits, min_size=1, max_size=12)):
        damaged[position] = value
    # The interesting bytes are the headers at the start and the index at the end.
    for position, value in data.draw(st.lists(st.tuples(st.integers(0, 3000), st.integers(0, 255)), max_size=6)):
        damaged[position] = value
        damaged[-1 - position] = value
    path = tmp_path / "damaged.mcap"
    path.write_bytes(bytes(damaged))
    try:
        read = read_all(path)
    except RecordingError as error:
        assert "\n" not in str(error)
    else:
        assert len(read) <= 60


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(noise=st.binary(max_size=400))
def test_noise_behind_the_magic_is_an_error(tmp_path: Path, noise: bytes) -> None:
    path = tmp_path / "noise.mcap"
    path.write_bytes(b"\x89MCAP0\r\n" + noise)
    with pytest.raises(RecordingError):
        read_all(path)


def test_a_killed_recording_is_made_whole(whole: bytes, tmp_path: Path) -> None:
    path = tmp_path / "cut.mcap"
    path.write_bytes(whole[: len(whole) * 2 // 3])
    before = read_all(path)
    rows = len(list(McapSource(path).rows(topics.TRACK)))
    saved = repair(path)
    source = McapSource(path)
    assert source.truncated is None
    assert source.metadata["format_version"] == "2"
    assert len(list(source.rows(topics.TRACK))) == rows
    for first, second in zip(before, source.frames(), strict=True):
        assert first.t_ns == second.t_ns
        np.testing.assert_array_equal(first.depth_mm, second.depth_mm)
        np.testing.assert_array_equal(first.color_rgb, second.color_rgb)
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()], validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None and summary.statistics is not None
        assert summary.statistics.message_count == saved
        depth = [m.decoded_message for m in reader.iter_decoded_messages(topics=[topics.DEPTH])]
    assert [image.data for image in depth] == [f.depth_mm.tobytes() for f in before]
    assert repair(path) == 0
    assert [p.name for p in tmp_path.iterdir()] == ["cut.mcap"]


@pytest.mark.parametrize("part", [0.05, 0.5, 0.99, 0.999, 1.0])
def test_made_whole_wherever_it_was_cut(whole: bytes, tmp_path: Path, part: float) -> None:
    """In the middle of a chunk, between the indexes of its messages, inside the closing records."""
    for back in (0, 17, 40, 93, 150):
        path = tmp_path / "cut.mcap"
        path.write_bytes(whole[: int(len(whole) * part) - 1 - back])
        try:
            before = read_all(path)
        except RecordingError:
            continue  # not one whole chunk
        assert repair(path) > 0
        assert McapSource(path).truncated is None
        assert [f.t_ns for f in read_all(path)] == [f.t_ns for f in before]
        with path.open("rb") as file:
            reader = make_reader(file, validate_crcs=True)
            times = [m.log_time for _, c, m in reader.iter_messages(topics=[topics.DEPTH])]
            summary = reader.get_summary()
        assert times == [f.t_ns for f in before]
        assert summary is not None and len(summary.chunk_indexes) == len(McapSource(path).file.scan.chunks)


def test_what_was_damaged_in_the_middle_is_kept_beside_the_repaired(whole: bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(whole)
    second = McapSource(path).file.scan.chunks[1]
    damaged = bytearray(whole)
    damaged[second.end + 1 : second.end + 9] = (7).to_bytes(8, "little")  # length of the message index behind it
    path.write_bytes(bytes(damaged))
    before = read_all(path)
    assert 0 < len(before) < 60
    assert repair(path) > 0
    assert [f.t_ns for f in read_all(path)] == [f.t_ns for f in before]
    assert (tmp_path / "a.mcap.damaged").read_bytes() == bytes(damaged)
    assert McapSource(path).truncated is None


def test_what_cannot_be_repaired_stays_as_it_is(whole: bytes, tmp_path: Path) -> None:
    path = tmp_path / "stub.mcap"
    path.write_bytes(whole[:60])
    with pytest.raises(RecordingError, match="nothing can be saved"):
        repair(path)
    assert path.read_bytes() == whole[:60]
    with pytest.raises(RecordingError, match="no recording at"):
        repair(tmp_path / "none.mcap")


def foreign(path: Path, options: MCAPWriteOptions | None = None, *, color: bool = False, **image: object) -> None:
    """A recording as another program writes it: depth alone, perhaps colour, no metadata."""
    context = Context()
    with open_mcap(path, context=context, writer_options=options):
        depth_channel = RawImageChannel(topics.DEPTH, context=context)
        color_channel = CompressedImageChannel(topics.COLOR, context=context)
        for i, frame in enumerate(frames(9)):
            fields = {
                "width": 64,
                "height": 48,
                "encoding": "16UC1",
                "step": 128,
                "data": frame.depth_mm.tobytes(),
            } | image
            depth_channel.log(RawImage(**fields), log_time=frame.t_ns)  # type: ignore[arg-type]
            if color and i % 3 == 0:
                jpeg = cv2.imencode(".jpg", np.full((48, 64, 3), 20 * i, np.uint8))[1].tobytes()
                color_channel.log(CompressedImage(data=jpeg, format="jpeg"), log_time=frame.t_ns + 4_000_000)


@pytest.mark.parametrize(
    "options",
    [
        MCAPWriteOptions(compression=MCAPCompression.Lz4),
        MCAPWriteOptions(compression=None),
        MCAPWriteOptions(use_chunks=False),
        MCAPWriteOptions(emit_message_indexes=False),
        MCAPWriteOptions(emit_statistics=False, emit_chunk_indexes=False, repeat_channels=False, repeat_schemas=False),
        MCAPWriteOptions(chunk_size=1000, calculate_chunk_crcs=False),
    ],
    ids=["lz4", "plain", "no chunks", "no message index", "no summary", "small chunks"],
)
def test_files_of_other_writers(tmp_path: Path, options: MCAPWriteOptions) -> None:
    path = tmp_path / "foreign.mcap"
    foreign(path, options)
    source = McapSource(path)
    assert source.info.frame_count == 9
    assert source.info.camera.mirrored is False
    for frame, original in zip(source.frames(), frames(9), strict=True):
        assert frame.t_ns == original.t_ns
        np.testing.assert_array_equal(frame.depth_mm, original.depth_mm)


def test_colour_at_a_lower_rate_is_matched_by_time(tmp_path: Path) -> None:
    path = tmp_path / "slow.mcap"
    foreign(path, color=True)
    greys = [int(f.color_rgb.mean()) for f in McapSource(path).frames() if f.color_rgb is not None]
    assert [round(g / 20) for g in greys] == [0, 0, 3, 3, 3, 6, 6, 6]


def test_rows_with_padding(tmp_path: Path) -> None:
    padded = np.zeros((48, 70), np.uint16)
    padded[:, :64] = frames(1)[0].depth_mm
    padded[:, 64:] = 9
    foreign(tmp_path / "a.mcap", step=140, data=padded.tobytes())
    first = next(McapSource(tmp_path / "a.mcap").frames())
    np.testing.assert_array_equal(first.depth_mm, frames(1)[0].depth_mm)


@pytest.mark.parametrize(
    ("image", "words"),
    [
        ({"encoding": "mono8", "step": 64}, "encoded as 'mono8'.*16UC1"),
        ({"width": 65, "step": 130}, "holds 6144"),
        ({"width": 0}, "says 0x48"),
        ({"step": 100}, "100 bytes a row"),
        ({"height": 4_000_000_000}, "4000000000"),
    ],
)
def test_depth_that_cannot_be_used(tmp_path: Path, image: dict[str, object], words: str) -> None:
    foreign(tmp_path / "a.mcap", **image)
    with pytest.raises(RecordingError, match=words):
        McapSource(tmp_path / "a.mcap")


def test_other_files_are_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="no recording at"):
        McapSource(tmp_path / "none.mcap")
    (tmp_path / "empty.mcap").touch()
    with pytest.raises(RecordingError, match="is empty"):
        McapSource(tmp_path / "empty.mcap")
    (tmp_path / "text.mcap").write_text("hello " * 50)
    with pytest.raises(RecordingError, match="not an MCAP"):
        McapSource(tmp_path / "text.mcap")
    with pytest.raises(RecordingError, match="cannot open"):
        McapSource(tmp_path)
    context = Context()
    with open_mcap(tmp_path / "json.mcap", context=context):
        Channel("/something", message_encoding="json", context=context).log({"a": 1})
    with pytest.raises(RecordingError, match=r"no depth on /camera/depth/image_raw; its topics are: /something"):
        McapSource(tmp_path / "json.mcap")
    context = Context()
    with open_mcap(tmp_path / "cdr.mcap", context=context):
        schema = Schema(name="sensor_msgs/msg/Image", encoding="ros2msg", data=b"uint8[] data")
        Channel(topics.DEPTH, schema=schema, message_encoding="cdr", context=context).log(b"123456789")
    with pytest.raises(RecordingError, match="encoded as 'cdr'"):
        McapSource(tmp_path / "cdr.mcap")
    context = Context()
    with open_mcap(tmp_path / "new.mcap", context=context) as writer:
        writer.write_metadata("teleop", {"format_version": "99"})
    with pytest.raises(RecordingError, match="format version 99"):
        McapSource(tmp_path / "new.mcap")


def test_a_folder_is_repaired_but_not_what_is_being_written(whole: bytes, tmp_path: Path) -> None:
    (tmp_path / "whole.mcap").write_bytes(whole)
    (tmp_path / "cut.mcap").write_bytes(whole[: len(whole) * 2 // 3])
    (tmp_path / "stub.mcap").write_bytes(whole[:60])
    (tmp_path / "notes.txt").write_text("no recording")
    with McapWriter(tmp_path / "open.mcap", camera(), source_uri="x") as writer:
        for frame in frames(40):
            writer.write_frame(frame)
        with pytest.raises(RecordingError, match="being written now"):
            repair(tmp_path / "open.mcap")
        lines = list(repair_folder(tmp_path))
    assert [line.split()[0] for line in lines] == ["cut.mcap", "stub.mcap"]
    assert "messages saved" in lines[0] and "cannot be repaired" in lines[1]
    assert McapSource(tmp_path / "cut.mcap").truncated is None
    assert (tmp_path / "whole.mcap").read_bytes() == whole and (tmp_path / "stub.mcap").read_bytes() == whole[:60]
    assert len(read_all(tmp_path / "open.mcap")) == 40
    assert len(list(repair_folder(tmp_path))) == 1, "only the stub is left"
    assert list(repair_folder(tmp_path / "missing")) == []
