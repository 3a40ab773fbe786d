"""The wire of push: what goes in comes out, and whatever else comes in is one clear error."""

from __future__ import annotations

import json

import cv2
import numpy as np
import pytest
import zstandard
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from teleop.errors import SourceError
from teleop.frames import Camera, DepthFrame, Intrinsics
from teleop.sources.jpeg import decode_jpeg, jpeg_size
from teleop.sources.push_codec import (
    PushWindow,
    decode_ack,
    decode_camera,
    decode_frame,
    encode_ack,
    encode_camera,
    encode_frame,
)

T = ((1.0, 0.0, 0.0, 0.025), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))
CAMERA = Camera(Intrinsics(50.5, 50.0, 3.5, 2.5, 8, 6), True, Intrinsics(60.0, 60.0, 7.0, 5.0, 16, 12), T)


@settings(max_examples=60)
@given(
    depth=hnp.arrays(np.uint16, (6, 8), elements=st.integers(0, 65535)),
    t_ns=st.integers(0, 2**63 - 1),
    seq=st.integers(0, 2**64 - 1),
)
def test_depth_time_and_number_come_back(depth: np.ndarray, t_ns: int, seq: int) -> None:
    frame = DepthFrame(t_ns, depth, CAMERA, None, seq)
    read = decode_frame(encode_frame(frame), CAMERA)
    assert (read.t_ns, read.seq, read.color_rgb) == (t_ns, seq, None)
    np.testing.assert_array_equal(read.depth_mm, depth)


def test_colour_comes_back_as_jpeg_keeps_it() -> None:
    color = np.zeros((12, 16, 3), np.uint8)
    color[..., 0] = 200
    read = decode_frame(encode_frame(DepthFrame(1, np.ones((6, 8), np.uint16), CAMERA, color)), CAMERA)
    assert read.color_rgb is not None
    assert np.abs(read.color_rgb.astype(int) - color).mean() < 3


def test_the_bytes_of_a_frame_are_fixed() -> None:
    """Golden bytes: a change here needs a new version number."""
    message = encode_frame(DepthFrame(0x0102030405060708, np.zeros((6, 8), np.uint16), CAMERA, None, 9))
    assert message[:28].hex() == "4754504601000000" + "0900000000000000" + "0807060504030201" + "08000600"
    assert int.from_bytes(message[28:32], "little") == len(message) - 36
    assert message[32:36] == bytes(4)


def test_the_camera_comes_back() -> None:
    for camera in (CAMERA, Camera()):
        assert decode_camera(encode_camera(camera, has_color=True)) == (camera, True)
        assert decode_camera(encode_camera(camera, has_color=False)) == (camera, False)


@settings(max_examples=200)
@given(data=st.data())
def test_damaged_messages_give_frames_or_one_error(data: st.DataObject) -> None:
    color = np.full((12, 16, 3), 90, np.uint8)
    message = bytearray(encode_frame(DepthFrame(5, np.full((6, 8), 900, np.uint16), CAMERA, color)))
    for position, value in data.draw(st.lists(st.tuples(st.integers(0, len(message) - 1), st.integers(0, 255)))):
        message[position] = value
    cut = data.draw(st.integers(0, len(message)))
    try:
        decode_frame(bytes(message[:cut]), CAMERA)
    except SourceError as error:
        assert "\n" not in str(error)


@settings(max_examples=100)
@given(text=st.text() | st.recursive(st.none() | st.integers() | st.text(), st.lists).map(json.dumps))
def test_other_texts_are_refused(text: str) -> None:
    with pytest.raises(SourceError):
        decode_camera(text)
    with pytest.raises(SourceError):
        decode_ack(text)


@pytest.mark.parametrize(
    "change",
    [
        {"fx": 0},
        {"fx": "wide"},
        {"width": 10**9},
        {"height": None},
        {"cx": float("inf")},
    ],
)
def test_a_camera_that_cannot_be(change: dict[str, object]) -> None:
    message = json.loads(encode_camera(CAMERA, has_color=True))
    message["camera"]["depth"].update(change)
    with pytest.raises(SourceError, match="not usable"):
        decode_camera(json.dumps(message))


def test_a_frame_of_another_size_or_a_bomb_is_refused() -> None:
    message = encode_frame(DepthFrame(5, np.ones((6, 8), np.uint16), CAMERA))
    with pytest.raises(SourceError, match="announced as 640x480"):
        decode_frame(message, Camera())
    bomb = zstandard.compress(bytes(1 << 24))
    header = bytearray(message[:36])
    header[28:32] = len(bomb).to_bytes(4, "little")
    with pytest.raises(SourceError, match="does not hold 8x6"):
        decode_frame(bytes(header) + bomb, CAMERA)


def test_the_size_of_a_jpeg_is_known_before_it_is_decoded() -> None:
    jpeg = cv2.imencode(".jpg", np.full((12, 16, 3), 90, np.uint8))[1].tobytes()
    assert jpeg_size(jpeg) == (16, 12)
    position = jpeg.index(b"\xff\xc0") + 5
    huge = jpeg[:position] + b"\xff\xff\xff\xff" + jpeg[position + 4 :]
    assert jpeg_size(huge) == (65535, 65535)
    assert decode_jpeg(huge) is None
    assert decode_jpeg(b"") is None
    assert decode_jpeg(jpeg[:4]) is None
    assert decode_jpeg(b"\x89PNG" + bytes(50)) is None


def test_acknowledgements() -> None:
    assert decode_ack(encode_ack(7)) == 7
    with pytest.raises(SourceError, match="busy"):
        decode_ack(json.dumps({"type": "error", "detail": "busy"}))


def test_the_window_holds_back_until_answers_come() -> None:
    window = PushWindow(size=2)
    assert [window.may_send(i, 0.0) for i in range(4)] == [True, True, False, False]
    assert window.dropped == 2
    window.acknowledged(0)
    assert [window.may_send(i, 0.1) for i in (4, 5)] == [True, False]
    # The answer to frame 1 was lost; that to 4 answers for it.
    window.acknowledged(4)
    assert window.on_the_way == 0
    assert [window.may_send(i, 0.2) for i in (6, 7, 8)] == [True, True, False]
    # Frame 6 never arrived; the answer to 7 tells, and 9 alone is on the way.
    assert not window.may_send(9, 0.3)
    window.acknowledged(7)
    assert window.may_send(10, 0.4) and window.on_the_way == 1


def test_a_window_full_of_lost_frames_opens_again() -> None:
    window = PushWindow(size=2, lost_s=1.0)
    assert window.may_send(0, 0.0) and window.may_send(1, 0.5)
    assert not window.may_send(2, 0.9)
    assert window.may_send(3, 1.1)
    assert not window.may_send(4, 1.2) and window.may_send(5, 1.6)
