"""The JSON row of ``teleop track``."""

import json

import numpy as np
from scripted import engaged, rig
from stick_figure import Person, raised, skeleton, without

from teleop.joints import JOINT_NAMES
from teleop.track_row import track_row

KEYS = ["t", "joints", "confidence", "angles", "hands", "zone", "mode", "command", "reasons"]


def test_row_of_a_working_operator() -> None:
    person = Person(legs_apart_deg=25, right=raised(outward_deg=62))
    r = engaged(person=person)
    out = r.hold(person, 2.0)[-1]
    row = json.loads(json.dumps(track_row(out.track, out.intent, out.command), allow_nan=False))
    assert list(row) == KEYS
    assert row["t"] == out.track.t_ns * 1e-9
    assert list(row["joints"]) == list(JOINT_NAMES) == list(row["confidence"])
    assert row["joints"]["head"] == [0.0, 0.7, 2.3]
    assert row["angles"]["theta1_right"] == 62.0
    assert row["command"]["right_arm"] == {"c1_deg": 0.0, "c2_deg": 60.0, "elbow_deg": 180.0}
    assert row["angles"]["T1"] == 25.0
    assert (row["zone"], row["mode"]) == ("work", "picking")
    assert row["hands"] == {"right": "unknown", "left": "unknown"}
    assert "hold.arm_locked" in row["reasons"]


def test_nobody_and_unknown_joints_are_null() -> None:
    r = rig()
    out = r.show(None)
    row = track_row(out.track, out.intent, out.command)
    assert set(row["joints"].values()) == {None} and set(row["angles"].values()) == {None}
    assert (row["zone"], row["mode"]) == ("none", "no_person")
    out = r.show(without(skeleton(Person()), "wrist_left"))
    row = json.loads(json.dumps(track_row(out.track, out.intent, out.command), allow_nan=False))
    assert row["joints"]["wrist_left"] is None and row["confidence"]["wrist_left"] == 0.0
    assert row["angles"]["theta3_left"] is None and row["angles"]["theta1_left"] is not None


def test_infinite_joints_never_reach_the_json() -> None:
    r = rig()
    body = skeleton(Person())
    body.joints_m[3] = np.inf
    body.confidence[4] = np.nan
    out = r.show(body)
    text = json.dumps(track_row(out.track, out.intent, out.command), allow_nan=False)
    assert json.loads(text)["joints"]["elbow_right"] is None


def test_assumed_operator_is_engaged_from_the_second_frame_on() -> None:
    r = rig(assume_engaged=True)
    modes = [out.intent.mode for out in r.hold(Person(z=1.6), 0.5)]
    assert modes[0] in ("engaged", "seen") and modes[-1] == "forward"
