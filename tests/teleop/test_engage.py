"""The engage gesture and the body stop."""

from dataclasses import replace

import pytest
from stick_figure import BESIDE_HEAD, CROSSED, Arm, Person, raised, skeleton, without

from teleop.angles import body_angles
from teleop.config.intent import AngleConfig, EngageConfig
from teleop.engage import GestureState, engage_pose, forearms_crossed, step_gestures
from teleop.intent_types import Hand, Hands
from teleop.joints import JOINT_INDEX

CONFIG = EngageConfig()
DT_S = 1 / 30
OPEN = Hands(Hand.OPEN, Hand.OPEN, 1.0, 1.0)
UP = Person(right=BESIDE_HEAD, left=BESIDE_HEAD)


def shows(person: Person, hands: Hands = OPEN) -> bool:
    body = skeleton(person)
    return engage_pose(body, body_angles(body, AngleConfig()), hands, CONFIG)


def test_both_open_hands_beside_the_head() -> None:
    assert shows(UP)
    assert not shows(Person())
    assert not shows(UP.but(left=raised()))
    assert not shows(UP, Hands(Hand.OPEN, Hand.FIST, 1.0, 1.0))
    assert not shows(Person(right=raised(outward_deg=140), left=raised(outward_deg=140))), "straight arms"


def test_unknown_joints_are_no_gesture() -> None:
    body = without(skeleton(UP), "hand_left")
    assert not engage_pose(body, body_angles(body, AngleConfig()), OPEN, CONFIG)


def test_forearms_crossed_before_the_chest() -> None:
    crossed = Person(right=CROSSED, left=CROSSED)
    assert forearms_crossed(skeleton(crossed), CONFIG)
    assert not forearms_crossed(skeleton(Person()), CONFIG)
    assert not forearms_crossed(skeleton(UP), CONFIG)
    reach = Arm((0.7, 0.0, -0.7), (1.0, 0.0, 0.0))
    assert not forearms_crossed(skeleton(Person(right=reach, left=reach)), CONFIG)
    assert not forearms_crossed(skeleton(crossed.but(left=raised())), CONFIG)
    assert not forearms_crossed(without(skeleton(crossed), "wrist_left"), CONFIG)


def test_folded_arms_are_crossed_though_the_elbow_under_them_is_found_elsewhere() -> None:
    """The tracker's own answer to arms folded flat: the left elbow, under the right arm, is 20 cm off."""
    found = skeleton(Person(right=CROSSED, left=CROSSED))
    places = {
        "elbow_right": (0.144, 0.085, 2.143), "wrist_right": (-0.099, 0.187, 2.121),
        "elbow_left": (-0.198, 0.21, 2.114), "wrist_left": (0.044, 0.098, 2.118),
        "shoulder_center": (0.0, 0.36, 2.3), "hip_center": (0.0, -0.15, 2.3),
    }  # fmt: skip
    joints = found.joints_m.copy()
    for name, place in places.items():
        joints[JOINT_INDEX[name]] = place
    assert forearms_crossed(replace(found, joints_m=joints), CONFIG)
    joints[JOINT_INDEX["wrist_left"]] = (-0.04, 0.098, 2.118)
    assert not forearms_crossed(replace(found, joints_m=joints), CONFIG), "wrists hardly past each other prove nothing"


def test_sides_taken_for_each_other_are_no_crossing() -> None:
    """A tracker that takes right for left shows the wrists far past each other, but the shoulders too."""
    forward = Arm((0.6, 0.2, -0.77), (0.98, 0.0, 0.2))
    found = skeleton(Person(right=forward, left=forward))
    joints = found.joints_m.copy()
    for name in ("shoulder", "elbow", "wrist", "hand"):
        pair = [JOINT_INDEX[f"{name}_right"], JOINT_INDEX[f"{name}_left"]]
        joints[pair] = joints[pair[::-1]]
    assert joints[JOINT_INDEX["wrist_left"], 0] - joints[JOINT_INDEX["wrist_right"], 0] > CONFIG.crossed_far_m
    assert not forearms_crossed(replace(found, joints_m=joints), CONFIG)
    joints[[JOINT_INDEX["shoulder_right"], JOINT_INDEX["shoulder_left"]]] = found.joints_m[
        [JOINT_INDEX["shoulder_right"], JOINT_INDEX["shoulder_left"]]
    ]
    assert forearms_crossed(replace(found, joints_m=joints), CONFIG), "the arms alone have changed sides: they cross"


def run(poses: list[tuple[bool, bool]]) -> list[tuple[bool, bool]]:
    state, out = GestureState(), []
    for engage, crossed in poses:
        gestures, state = step_gestures(state, engage, crossed, DT_S, CONFIG)
        assert 0.0 <= gestures.progress <= 1.0
        out.append((gestures.toggle, gestures.stop))
    return out


def test_held_for_a_second_counts_once() -> None:
    out = run([(True, False)] * 120)
    toggles = [i for i, (toggle, _) in enumerate(out) if toggle]
    assert len(toggles) == 1
    assert (toggles[0] + 1) * DT_S == pytest.approx(CONFIG.hold_s, abs=1.5 * DT_S)


def test_let_go_and_held_again_counts_again() -> None:
    out = run([(True, False)] * 40 + [(False, False)] * 20 + [(True, False)] * 40)
    assert sum(toggle for toggle, _ in out) == 2


def test_a_short_gesture_does_not_count_and_one_bad_frame_does_not_end_it() -> None:
    assert not any(toggle for toggle, _ in run([(True, False)] * 25 + [(False, False)] * 60))
    assert any(toggle for toggle, _ in run([(i % 10 != 9, False) for i in range(60)]))


def test_crossed_for_a_third_of_a_second_stops() -> None:
    out = run([(False, True)] * 30)
    first = [stop for _, stop in out].index(True)
    assert (first + 1) * DT_S == pytest.approx(CONFIG.crossed_s, abs=1.5 * DT_S)
    assert not any(stop for _, stop in run([(False, True)] * 6 + [(False, False)] * 10))
