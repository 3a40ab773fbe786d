"""``teleop record`` and ``teleop replay --verify`` over the bundled recording, with the real pipeline and robot."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from live_server import frames, tracker

from robot_sim.world import World
from server.cli.record_run import RecordOptions, record_session
from server.cli.replay_run import RecordedStep, compare, recorded_settings, unlike
from server.cli.replay_words import lines, whatif_lines
from server.engine.core import Core
from server.engine.ledger import Ledger
from server.engine.mailbox import Arrived
from server.engine.recording import SessionRecorder, describe
from server.settings import Settings, bundled_recordings, changed
from teleop.body.model import load_model
from teleop.errors import RecordingError, TeleopError
from teleop.inputs import Inputs, RobotRequest
from teleop.intent_types import Event, Mode
from teleop.reasons import Reason
from teleop.recording import McapSource, McapWriter, topics
from teleop.recording.comparison import NOTICEABLE, Comparison
from teleop.recording.inputs_json import inputs_to_json
from teleop.sources import open_source
from teleop.sources.base import SourceInfo
from teleop.sources.jpeg import through_jpeg


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three seconds of the bundled recording, its operator engaged, with everything that happened."""
    path = tmp_path_factory.mktemp("replay") / "session.mcap"
    source = open_source(str(bundled_recordings() / "greenhouse_demo.mcap"))
    count = record_session(source, path, Settings(), RecordOptions(seconds=3.0, engage=True))
    source.close()
    assert count == 61
    return path


def verified(path: Path, change: dict[str, Any] | None = None) -> Comparison:
    source = McapSource(path)
    try:
        assert unlike(source, load_model()) == []
        return compare(source, load_model(), change)
    finally:
        source.close()


def test_a_recorded_session_replays_bit_for_bit(recording: Path) -> None:
    found = verified(recording)
    assert found.identical and found.frames == 61, lines(found, [])


def test_the_session_moved_the_robot(recording: Path) -> None:
    source = McapSource(recording)
    modes = {row["mode"] for _, row in source.rows(topics.TRACK)}
    states = source.file.topics[topics.JOINT_STATES]
    first, last = (source.file.message(topics.JOINT_STATES, i).joints for i in (0, len(states.t_ns) - 1))
    source.close()
    assert Mode.ENGAGED in modes
    assert [j.position for j in first] != [j.position for j in last]


def test_other_settings_are_summarised(recording: Path) -> None:
    found = verified(recording, {"teleop": {"body": {"filter": {"enabled": False}}}})
    assert not found.identical and found.differing > 20 and found.missing == 0
    # without the filter a wrist may jump by its whole reach
    assert 0 < found.groups["joints"].largest < 1.5
    text = whatif_lines(found)
    assert text[0].endswith("of 61 frames would have been different") and "operator's angles [deg]" in text
    angles = next(line for line in text if line.startswith("  theta1_right: "))
    assert " s on, up to " in angles
    assert whatif_lines(verified(recording, {})) == ["61 frames: these settings would have changed nothing noticeable"]


def test_a_change_of_words_is_told_with_its_begin() -> None:
    found = Comparison()
    for i in range(10):
        before = {"mode": "picking", "command": {"gripper_open": None}, "reasons": ["a"]}
        after = {"mode": "picking" if i < 4 else "held", "command": {"gripper_open": i > 6}, "reasons": ["a"]}
        found.add(5_000_000_000 + i * 100_000_000, before, after)
    assert whatif_lines(found) == [
        "10 of 10 frames would have been different",
        "mode, zone, hands",
        "  mode: 6 frames (60 %) from 0.40 s on, picking -> held",
        "tools",
        "  gripper_open: 10 frames (100 %) from 0.00 s on, none -> False",
    ]


def test_what_nobody_would_notice_is_left_out_of_a_what_if() -> None:
    found = Comparison(blind=NOTICEABLE)
    found.add(0, {"robot": {"lift": 0.1, "disc": 0.5}}, {"robot": {"lift": 0.1 + 1e-6, "disc": 0.5}})
    assert found.identical
    found.add(1, {"robot": {"lift": 0.1, "disc": 0.5}}, {"robot": {"lift": 0.1 + 1e-6, "disc": 0.6}})
    assert list(found.leaves) == ["robot.disc"] and found.differing == 1


def test_another_build_of_the_same_version_is_told_apart(recording: Path) -> None:
    source = McapSource(recording)
    source.metadata["sources_sha256"] = "0" * 64
    assert unlike(source, load_model()) == ["sources_sha256"]
    source.close()


def test_all_inputs_of_a_live_session_count(tmp_path: Path) -> None:
    """Silence, watchdog, requests, e-stop, refused stamps and a change of settings, as the engine's loop gives them."""
    path, settings = tmp_path / "live.mcap", Settings()
    now_s = 100.0
    world = World(settings.robot)
    body = tracker(settings)
    info = SourceInfo("push:", "push", frames()[0].camera, live=True, has_color=True)
    events: list[Event] = []
    described = describe(settings, body.model, world)
    recorder = SessionRecorder(path, info, world.urdf, events.append, described, lossless=True)
    core = Core(body, world, settings, Ledger(10), lambda: now_s)
    core.forget(reset_robot=True)
    core.pending.ask(RobotRequest(lift_m=0.25, drive_m_s=0.1), now_s + 0.4)
    for i in range(3):
        recorder.write(core.on_silence(False, 1.0))  # before the first frame
        now_s += 0.03 + i * 0.001
    for i, frame in enumerate(frames()[:24]):
        now_s += 0.0337 + 0.0011 * (i % 3)
        core.pending.engage = i == 3
        if i == 8:
            core.estop()
        if i == 12:
            core.estop_reset()
        if i == 15:
            settings = changed(settings, {"teleop": {"body": {"filter": {"enabled": False}}}})
            core.configure(settings)
            recorder.write_settings(settings)
        told = replace(through_jpeg(frame), t_ns=frames()[9].t_ns) if i == 10 else through_jpeg(frame)
        if i != 10:
            recorder.receive(told)  # as the source's thread does
        assert recorder.write(core.on_frame(Arrived(told, now_s - 0.004, 0.0), live=True, speed=1.0))
        if i in (5, 8, 18):
            for _ in range(9):
                now_s += 0.0331
                recorder.write(core.on_silence(i == 18, 1.0))
        if i == 20:  # latched and released while no frame comes
            core.estop()
            recorder.write(core.on_silence(False, 1.0))
            core.estop_reset()
            recorder.write(core.on_silence(False, 1.0))
    recorder.close()
    world.close()
    assert not events
    source = McapSource(path)
    rows = [row for _, row in source.rows(topics.INPUTS)]
    source.close()
    shown = McapSource(path)
    stamps = shown.file.topics[topics.JOINT_STATES].t_ns
    shown.close()
    assert len(stamps) > 23 + 10 and all(a <= b for a, b in pairwise(stamps)), "the robot is seen in the silence, too"
    assert sum("settings" in row for row in rows) == 1
    codes = {code for row in rows for code in row.get("watchdog", ())}
    assert codes == {Reason.NO_FRAME_HOLD, Reason.SOURCE_FAILED}
    assert sum(bool(row.get("frame")) and not row["stored"] for row in rows) == 1
    found = verified(path)
    assert found.identical and found.frames == 23, lines(found, [])
    assert found.between == 3 * 9 + 2 + 1, "steps in silence, and the one whose stamp was refused"
    assert lines(found, [])[0].startswith("23 frames and 30 steps between them: ")


def test_a_difference_between_two_frames_counts() -> None:
    found = Comparison()
    found.add(0, {"robot": {"lift": 0.1}}, {"robot": {"lift": 0.1}})
    found.add_between(0, {"reasons": ["stop.no_frame"]}, {"reasons": []})
    assert not found.identical and found.frames == 1 and found.between == 1


def test_what_cannot_be_verified_is_said(tmp_path: Path) -> None:
    source = McapSource(bundled_recordings() / "greenhouse_demo.mcap")
    with pytest.raises(RecordingError, match=r"nothing to verify.*teleop record"):
        compare(source, load_model())
    source.close()


def test_a_comparison_is_plain_json(recording: Path) -> None:
    from dataclasses import asdict

    found = Comparison()
    found.add(0, {"a": 1.0}, {"a": 1.0000000000000002})
    assert not found.identical and json.loads(json.dumps(asdict(found.groups["a"])))["frames"] == 1


@pytest.mark.parametrize(
    "damage",
    [{"now_s": None}, {"now_s": "soon"}, {"speed": math.inf}, {"received_s": None}, {"frame_t_ns": []}, {"engage": 3}],
)
def test_a_damaged_row_of_inputs_is_one_error(damage: dict[str, Any]) -> None:
    row = inputs_to_json(Inputs()) | {"now_s": 1.0, "speed": 1.0, "live": False, "latched": False, "stored": True}
    row |= {"frame": True, "frame_t_ns": 5, "received_s": 1.0}
    assert RecordedStep(row).frame_t_ns == 5
    with pytest.raises(RecordingError, match="/teleop/inputs cannot be read"):
        RecordedStep(row | damage)


@pytest.mark.parametrize("text", ["[1]", "{", '{"teleop": 5}', '{"unheard": {}}'])
def test_damaged_settings_are_one_error(tmp_path: Path, text: str) -> None:
    path = tmp_path / "a.mcap"
    with McapWriter(path, frames()[0].camera, source_uri="x", metadata={topics.KEY_SETTINGS: text}) as writer:
        writer.write_frame(frames()[0])
    source = McapSource(path)
    with pytest.raises(TeleopError):
        recorded_settings(source)
    source.close()
