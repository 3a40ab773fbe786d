"""What exact replay rests on: inputs and colour that come back bit for bit, and a comparison that sees a last bit."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from recording_frames import camera

from robot_sim.commands import ArmTarget, Liquid
from teleop.body.model import load_model
from teleop.config.recording import RecordingConfig
from teleop.errors import RecordingError
from teleop.frames import DepthFrame
from teleop.inputs import Inputs, RobotRequest
from teleop.recording import AsyncRecorder, McapSource, McapWriter
from teleop.recording.comparison import Comparison
from teleop.recording.identity import model_digest
from teleop.recording.inputs_json import inputs_from_json, inputs_to_json
from teleop.sources.jpeg import through_jpeg

NUMBER = st.none() | st.floats()
ARM = st.none() | st.builds(ArmTarget, st.floats(), st.floats(), st.floats())
SWITCH = st.none() | st.booleans()
REQUEST = st.builds(
    RobotRequest,
    NUMBER,
    NUMBER,
    ARM,
    ARM,
    ARM,
    NUMBER,
    NUMBER,
    SWITCH,
    SWITCH,
    SWITCH,
    st.sampled_from([None, *Liquid]),
)
INPUTS = st.builds(
    Inputs,
    st.booleans(),
    st.booleans(),
    st.booleans(),
    st.booleans(),
    st.none() | REQUEST,
    st.just(()),
    st.none() | st.integers(0, 1 << 62),
)


@given(INPUTS)
def test_inputs_come_back_bit_for_bit(inputs: Inputs) -> None:
    text = json.dumps(inputs_to_json(inputs), allow_nan=False)
    assert repr(inputs_from_json(json.loads(text))) == repr(inputs), "repr tells -0.0 and nan"


@pytest.mark.parametrize(
    "damage",
    [{"engage": 1}, {"request": {"fly": True}}, {"request": {"liquid": "beer"}}, {"receive_t_ns": "soon"}],
)
def test_damaged_inputs_are_one_error(damage: dict[str, object]) -> None:
    row = inputs_to_json(Inputs()) | damage
    with pytest.raises(RecordingError, match="/teleop/inputs cannot be read"):
        inputs_from_json(row)
    with pytest.raises(RecordingError):
        inputs_from_json({})


def noisy(t_ns: int) -> DepthFrame:
    rng = np.random.default_rng(t_ns)
    cam = camera()
    shape = (cam.depth.height, cam.depth.width)
    return DepthFrame(t_ns, rng.integers(0, 4000, shape, np.uint16), cam, rng.integers(0, 255, (*shape, 3), np.uint8))


def test_colour_comes_back_as_it_was_used_however_often_it_is_recorded(tmp_path: Path) -> None:
    used = through_jpeg(noisy(7))
    assert used.color_rgb is not None and through_jpeg(used) is used
    frame = used
    for name in ("a.mcap", "b.mcap"):
        with McapWriter(
            tmp_path / name, frame.camera, source_uri="test", config=RecordingConfig(jpeg_quality=40)
        ) as writer:
            writer.write_frame(frame)
        source = McapSource(tmp_path / name)
        (frame,) = source.frames()
        source.close()
        assert frame.color_jpeg == used.color_jpeg
        np.testing.assert_array_equal(frame.color_rgb, used.color_rgb)
    assert frame.without_color().color_jpeg is None


def test_a_lossless_recorder_waits_for_the_disk(tmp_path: Path) -> None:
    with McapWriter(tmp_path / "a.mcap", camera(), source_uri="test") as writer:
        recorder = AsyncRecorder(writer, capacity=2, lossless=True)
        for i in range(40):
            recorder.write_frame(noisy(i * 33_000_000))
        status = recorder.close()
    assert (status.frames_written, status.frames_dropped, status.colors_dropped) == (40, 0, 0)


def test_a_comparison_sees_the_last_bit_and_the_tolerance_forgives_it() -> None:
    before = {"joints": {"head": [0.0, 0.1, 2.0], "hand": None}, "mode": "engaged", "reasons": []}
    after = {"joints": {"head": [0.0, 0.1, math.nextafter(2.0, 3.0)], "hand": None}, "mode": "engaged", "reasons": []}
    found = Comparison()
    found.add(0, before, before)
    assert found.identical and found.within_tolerance
    found.add(1, before, after)
    assert not found.identical and found.within_tolerance
    assert found.first is not None and (found.first.t_ns, found.first.where) == (1, "joints.head.2")
    assert found.groups["joints"].frames == 1 and found.groups["joints"].beyond == 0


@pytest.mark.parametrize(
    "change", [{"mode": "held"}, {"reasons": ["hold.x"]}, {"joints": {"head": None}}, {"joints": {"head": [0, 0, 2.1]}}]
)
def test_another_word_a_lost_joint_or_a_far_one_is_beyond(change: dict[str, object]) -> None:
    before = {"joints": {"head": [0.0, 0.0, 2.0]}, "mode": "engaged", "reasons": []}
    found = Comparison()
    found.add(0, before, before | change)
    assert found.differing == 1 and not found.within_tolerance


def test_nothing_compared_is_not_identical() -> None:
    assert not Comparison().identical and not Comparison().within_tolerance


def test_a_models_digest_knows_its_numbers_not_its_provenance() -> None:
    model = load_model()
    digest = model_digest(model)
    assert digest == model_digest(load_model())
    assert digest == model_digest(replace(model, meta={"made": "elsewhere"}))
    moved = model.bandwidth_m.copy()
    moved[0] = math.nextafter(moved[0], 1.0)
    assert digest != model_digest(replace(model, bandwidth_m=moved))
