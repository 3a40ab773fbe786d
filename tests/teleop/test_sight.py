"""The operator's body: levelled, gated, kept for a moment, and not mistaken for another's."""

import numpy as np
import pytest
from stick_figure import Person, joints, skeleton, track, without

from teleop.config import OperatorConfig, TeleopConfig
from teleop.config.intent import IntentConfig, LevelConfig
from teleop.joints import JOINT_INDEX
from teleop.level import rotation_level_camera
from teleop.reasons import Reason
from teleop.sight import Sight, step_sight
from teleop.skeleton import FloorPlane, Skeleton, Track

CONFIG = IntentConfig()
DT_S = 1 / 30


def watch(people: list[Person | None], engaged: bool = True, sight: Sight = Sight()) -> list[Sight]:
    out = []
    for person in people:
        sight = step_sight(sight, track(person, 0), DT_S, engaged, CONFIG)
        out.append(sight)
    return out


def of(joints_m: np.ndarray, floor: FloorPlane | None = None) -> Track:
    return Track(0, Skeleton(0, joints_m, np.ones(20)), None, floor, None, None)


@pytest.mark.parametrize("tilt_deg", [-15.0, 10.0, 15.0])
def test_levelling_undoes_the_tilt_seen_or_calibrated(tilt_deg: float) -> None:
    t = np.radians(tilt_deg)
    # the axis of a camera tilted up by t has the upward component sin t
    up = np.array([0.0, np.cos(t), np.sin(t)])
    R_camera_level = np.array([[1, 0, 0], [0, np.cos(t), -np.sin(t)], [0, np.sin(t), np.cos(t)]])
    level = joints(Person())
    seen = level @ R_camera_level.T
    assert (R_camera_level @ [0.0, 1.0, 0.0]) == pytest.approx(up)
    body = step_sight(Sight(), of(seen, FloorPlane(up, 1.0)), 0.0, True, CONFIG).body
    assert body is not None and np.allclose(body.joints_m, level, atol=1e-9)
    R = rotation_level_camera(None, LevelConfig(tilt_deg=tilt_deg))
    assert np.allclose(seen @ R.T, level, atol=1e-9)
    assert np.array_equal(rotation_level_camera(FloorPlane(up, 1.0), LevelConfig(level="off")), np.eye(3))


def test_operator_is_kept_for_a_moment_and_then_gone() -> None:
    sights = watch([Person()] * 5 + [None] * 90)
    lost = [i for i, s in enumerate(sights) if s.body is None]
    assert lost[0] * DT_S - 5 * DT_S == pytest.approx(CONFIG.safety.lost_disengage_s, abs=0.1)
    assert not sights[5].seen_now and sights[4].seen_now
    bystander = watch([Person()] * 5 + [None] * 30, engaged=False)
    assert bystander[-1].body is None


def test_another_person_elsewhere_is_not_the_operator() -> None:
    sights = watch([Person()] * 5 + [Person(x=1.0)] * 20)
    assert Reason.OPERATOR_JUMP in sights[5].reasons and not sights[5].seen_now
    exchanged = [i for i, s in enumerate(sights) if s.exchanged]
    assert len(exchanged) == 1
    assert (exchanged[0] - 5) * DT_S == pytest.approx(CONFIG.safety.lost_hold_s, abs=0.1)


def test_a_short_jump_of_the_whole_track_is_forgotten() -> None:
    sights = watch([Person()] * 5 + [Person(x=1.0)] * 4 + [Person()] * 5)
    assert not any(s.exchanged for s in sights)
    assert sights[9].seen_now


def test_who_comes_back_elsewhere_after_a_loss_is_another() -> None:
    sights = watch([Person()] * 5 + [None] * 20 + [Person(x=0.9)] * 5)
    assert any(s.exchanged for s in sights)
    back = watch([Person()] * 5 + [None] * 20 + [Person(x=0.2)] * 5)
    assert not any(s.exchanged for s in back) and back[-1].seen_now


def test_a_walking_operator_stays_the_operator() -> None:
    sights = watch([Person(x=0.0, z=1.5 + 1.5 * DT_S * i) for i in range(40)])
    assert all(s.seen_now and not s.exchanged for s in sights)


def test_impossible_joints_are_unknown_for_as_long_as_they_are_impossible() -> None:
    sight = watch([Person()] * 5)[-1]
    moved = joints(Person())
    moved[JOINT_INDEX["hand_right"]] += (0.0, 1.2, 0.0)
    sight = step_sight(sight, of(moved), DT_S, True, CONFIG)
    assert sight.reasons == (Reason.JOINT_JUMP,)
    assert sight.body is not None and sight.body.joint("hand_right") is None
    assert sight.shown is not None and sight.shown.joint("hand_right") is not None
    for _ in range(6):
        sight = step_sight(sight, of(moved), DT_S, True, CONFIG)
    assert sight.body is not None and sight.body.joint("hand_right") is not None


@pytest.mark.parametrize("value", [np.inf, -np.inf, 1e6])
def test_joints_that_are_no_places_are_refused(value: float) -> None:
    moved = joints(Person())
    moved[JOINT_INDEX["elbow_left"], 2] = value
    sight = step_sight(Sight(), of(moved), DT_S, True, CONFIG)
    assert Reason.JOINT_NOT_FINITE in sight.reasons
    assert sight.body is not None and sight.body.joint("elbow_left") is None
    moved[JOINT_INDEX["spine"]] = value
    sight = step_sight(Sight(), of(moved), DT_S, True, CONFIG)
    assert sight.body is None


def test_unknown_joints_are_no_fault() -> None:
    body = without(skeleton(Person()), "hand_left", "knee_right")
    sight = step_sight(Sight(), Track(0, body, None, None, None, None), DT_S, True, CONFIG)
    assert sight.reasons == ()


@pytest.mark.parametrize(("name", "stretched"), [("elbow_right", 0.4), ("elbow_right", 2.0), ("knee_left", 1.8)])
def test_a_joint_at_the_end_of_an_impossible_bone_is_unknown(name: str, stretched: float) -> None:
    start = {"elbow_right": "shoulder_right", "knee_left": "hip_left"}[name]
    points = joints(Person())
    a, b = JOINT_INDEX[start], JOINT_INDEX[name]
    points[b] = points[a] + stretched * (points[b] - points[a])
    sight = step_sight(Sight(), of(points), DT_S, True, CONFIG)
    assert sight.reasons == (Reason.BONE_LENGTH,)
    assert sight.body is not None and sight.body.joint(name) is None
    beyond = {"elbow_right": "hand_right", "knee_left": "foot_left"}[name]
    assert sight.body.joint(beyond) is None and sight.body.joint("elbow_left") is not None
    assert sight.shown is not None and sight.shown.joint(name) is not None


def test_a_body_without_a_possible_trunk_is_not_seen_and_a_profile_judges_sharper() -> None:
    points = joints(Person())
    points[JOINT_INDEX["shoulder_center"], 1] += 0.5
    sight = step_sight(Sight(), of(points), DT_S, True, CONFIG)
    assert sight.body is None and Reason.BONE_LENGTH in sight.reasons
    points = joints(Person())
    shoulder = points[JOINT_INDEX["shoulder_right"]]
    points[JOINT_INDEX["elbow_right"]] = shoulder + 1.4 * (points[JOINT_INDEX["elbow_right"]] - shoulder)
    own = TeleopConfig(operator=OperatorConfig(name="ann", bones_m={"upper_arm": 0.30})).effective_intent()
    assert step_sight(Sight(), of(points), DT_S, True, CONFIG).reasons == ()
    assert step_sight(Sight(), of(points), DT_S, True, own).reasons == (Reason.BONE_LENGTH,)


def test_a_floor_that_tilts_at_once_is_doubted_until_it_has_stayed() -> None:
    up, tilted = np.array([0.0, 1.0, 0.0]), np.array([0.0, np.cos(0.2), np.sin(0.2)])
    sight, doubted = Sight(), []
    for normal in [up] * 5 + [tilted] * 3 + [up] * 5 + [tilted] * 30:
        sight = step_sight(sight, of(joints(Person()), FloorPlane(normal, 1.0)), DT_S, True, CONFIG)
        assert sight.body is not None
        level = bool(np.allclose(sight.body.joints_m, joints(Person())))
        assert level or Reason.FLOOR_JUMP not in sight.reasons
        doubted.append(Reason.FLOOR_JUMP in sight.reasons)
    assert [i for i, doubt in enumerate(doubted[:13]) if doubt] == [5, 6, 7]
    assert sum(doubted[13:]) * DT_S == pytest.approx(CONFIG.level.settle_s, abs=2 * DT_S) and not doubted[-1]
    assert not level, "a sensor that was moved is believed in the end"


def test_left_right_swap_does_not_move_the_trunk() -> None:
    sight = watch([Person()] * 5)[-1]
    swapped = joints(Person())
    for a, b in (("shoulder_right", "shoulder_left"), ("elbow_right", "elbow_left"), ("wrist_right", "wrist_left")):
        i, j = JOINT_INDEX[a], JOINT_INDEX[b]
        swapped[[i, j]] = swapped[[j, i]]
    sight = step_sight(sight, of(swapped), DT_S, True, CONFIG)
    assert Reason.JOINT_JUMP in sight.reasons
    assert sight.body is not None and sight.body.joint("shoulder_right") is None
