"""The servo controller's lines: what was written is read again, what is damaged is never taken for something else."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from robot_sim.actuators import JOINTS
from robot_sim.link.servo_protocol import (
    LONGEST_LINE,
    Move,
    Reply,
    Request,
    decode_reply,
    decode_request,
    encode_reply,
    encode_request,
)

numbers = st.integers(0, 999)
speeds = st.integers(-9999, 9999)
servos = st.dictionaries(st.integers(0, len(JOINTS) - 1), st.integers(-180, 400))
moves = st.builds(Move, speeds, speeds, st.integers(-1, 2), servos)
requests = st.one_of(
    st.builds(Request, numbers, st.just("M"), moves), st.builds(Request, numbers, st.sampled_from(("X", "R", "Q")))
)


def test_a_line_as_the_document_has_it() -> None:
    request = Request(7, "M", Move(100, 100, -1, {2: 45, 4: 45}))
    assert encode_request(request) == b"$7,M,100,100,-1,2=45,4=45*60\n"
    assert encode_reply(Reply(7)) == b"!7,OK*1F\n"
    assert encode_reply(Reply(7, "range")) == b"!7,ER,range*5F\n"


@given(requests)
def test_requests_round_trip_and_stay_short(request: Request) -> None:
    line = encode_request(request)
    assert decode_request(line) == request
    assert len(line) <= LONGEST_LINE


@given(requests, st.data())
def test_one_damaged_byte_is_always_noticed(request: Request, data: st.DataObject) -> None:
    line = bytearray(encode_request(request))
    at = data.draw(st.integers(0, len(line) - 2))
    line[at] = data.draw(st.integers(0, 255).filter(lambda b: b != line[at]))
    assert isinstance(decode_request(bytes(line)), str)


@given(st.binary(max_size=60))
def test_noise_never_raises(noise: bytes) -> None:
    assert isinstance(decode_request(noise), Request | str)
    assert decode_reply(noise) is None or isinstance(decode_reply(noise), Reply)
