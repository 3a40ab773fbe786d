"""The demonstration: smooth, plausible speeds, and every zone and mode of the specification in it."""

import numpy as np
import pytest

from teleop.frames import Camera, DepthFrame, kinect_v1
from teleop.intent_types import Mode, Zone
from teleop.joints import JOINT_INDEX
from teleop.people.body import skin
from teleop.people.builtin import builtin_body
from teleop.people.motion import minimum_jerk
from teleop.people.performance import Take
from teleop.people.pose import pose_rig
from teleop.people.rig import joints_m
from teleop.people.scene import stand
from teleop.people.story import greenhouse_story
from teleop.people.truth import truth_row, zone_of
from teleop.people.view import sensor_view

FPS = 20
VIEW = sensor_view(1.2, -0.03)


@pytest.fixture(scope="module")
def takes():
    body = builtin_body()
    motion, _ = greenhouse_story(1)
    camera, out = Camera(kinect_v1(320, 240)), []
    empty = np.zeros((240, 320), np.uint16)
    for n in range(int(motion.duration_s * FPS) + 1):
        moment = motion.at(n / FPS)
        posed = pose_rig(body.rig, moment.pose)
        posed = stand(posed, skin(body, posed), moment.x_m, moment.z_m, moment.turn).moved(VIEW.R, VIEW.t_m)
        out.append(Take(DepthFrame(round(n / FPS * 1e9), empty, camera), joints_m(body.rig, posed), moment))
    return out


@pytest.fixture(scope="module")
def rows(takes):
    _, chapters = greenhouse_story(1)
    return [truth_row(take, chapters, VIEW) for take in takes]


def test_no_joint_moves_faster_than_a_person_does(takes):
    joints = np.stack([take.joints_m for take in takes])
    speed = np.linalg.norm(np.diff(joints, axis=0), axis=2) * FPS
    assert speed.max() < 4.5
    assert np.abs(np.diff(speed, axis=0)).max() < 2.0


def test_it_lasts_as_long_as_promised():
    assert 35 <= greenhouse_story(1)[0].duration_s <= 45


def test_all_zones_that_the_story_needs_are_entered_while_engaged(rows):
    zones = [row["zone"] for row in rows if row["engaged"]]
    assert {Zone.FORWARD, Zone.WORK, Zone.BACK, Zone.RIGHT} <= set(zones)


def test_the_story_starts_and_ends_with_nobody_there(rows):
    assert rows[0]["mode"] == rows[-1]["mode"] == Mode.NO_PERSON


@pytest.mark.parametrize(("chapter", "mode"), [("pick", Mode.PICKING), ("spray", Mode.SPRAYING)])
def test_legs_select_the_task(rows, chapter, mode):
    inside = [row for row in rows if row["chapter"] == chapter][:-FPS]
    assert {row["mode"] for row in inside} == {mode}
    assert {row["hands"]["right"] for row in inside} >= {"open", "fist"}
    assert {row["hands"]["left"] for row in inside} >= {"open", "fist"}


def test_the_upper_arm_passes_through_many_bins(takes, rows):
    seen = set()
    for take, row in zip(takes, rows, strict=True):
        if row["chapter"] == "pick":
            j = take.joints_m
            d = (j[JOINT_INDEX["elbow_right"]] - j[JOINT_INDEX["shoulder_right"]])[:2]
            seen.add(round(float(np.degrees(np.arctan2(abs(d[0]), -d[1]))) / 15) * 15)
    assert {15, 30, 45, 60} <= seen


def test_both_gestures_hold_the_hands_beside_the_head_for_a_second(takes, rows):
    for chapter in ("engage", "disengage"):
        held = 0
        for take, row in zip(takes, rows, strict=True):
            j = take.joints_m
            near = all(
                abs(j[JOINT_INDEX[f"hand_{s}"], 1] - j[JOINT_INDEX["head"], 1]) < 0.15 for s in ("right", "left")
            )
            held += row["chapter"] == chapter and near and row["hands"] == {"right": "open", "left": "open"}
        assert held >= 1.2 * FPS


@pytest.mark.parametrize(
    ("x", "z", "zone"),
    [
        (0.0, 1.39, Zone.OUT),
        (0.0, 1.5, Zone.FORWARD),
        (0.39, 2.3, Zone.WORK),
        (0.5, 2.3, Zone.RIGHT),
        (-0.5, 1.5, Zone.LEFT),
        (0.0, 3.0, Zone.BACK),
        (0.0, 3.41, Zone.OUT),
        (0.95, 2.3, Zone.OUT),
    ],
)
def test_zones_are_those_of_the_specification(x, z, zone):
    assert zone_of(np.array([x, 0.0, z])) is zone


def test_minimum_jerk_starts_and_ends_at_rest():
    assert minimum_jerk(0.0) == (0.0, 0.0)
    assert minimum_jerk(1.0) == (1.0, 0.0)
    assert minimum_jerk(0.5)[0] == pytest.approx(0.5)
