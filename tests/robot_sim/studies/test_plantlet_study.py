"""The plantlet study: way points, straight and clear entry, the error model and its calibration."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from robot_sim.arms.config import PlantletArmConfig
from robot_sim.arms.plantlet import plantlet_arm, plantlet_model
from robot_sim.errors import RobotError
from robot_sim.studies.bottle import Bottle, surface_points
from robot_sim.studies.calibration import calibrate, compensated
from robot_sim.studies.config import BottleConfig, PlantletStudyConfig
from robot_sim.studies.plantlet import clearance_table, moving_bodies, run_plantlet_study
from robot_sim.studies.plantlet_path import plan_cycle
from robot_sim.studies.plantlet_tables import carrying_targets, compare
from robot_sim.studies.servo_model import built_chain, draw_errors, fit_errors, share_within, tip_errors

ARM, STUDY = plantlet_arm(), PlantletStudyConfig()
CYCLE = plan_cycle(ARM, STUDY)


def wrist_mm(name: str) -> np.ndarray:
    """The wrist frame's place at a way point."""
    return ARM.chain.frames(CYCLE.points[name])[-2, :3, 3] * 1e3


def test_way_points_are_the_sources() -> None:
    np.testing.assert_allclose(wrist_mm("P1"), (250, 0, 150), atol=1e-6)
    np.testing.assert_allclose(wrist_mm("P2"), (250, 0, 70), atol=1e-6)
    np.testing.assert_allclose(wrist_mm("P4") - wrist_mm("P5"), (0, 0, 80), atol=1e-6)
    T1, TA = (ARM.chain.forward(CYCLE.points[n]) for n in ("P1", "A"))
    np.testing.assert_allclose(T1[:3, 2], (0, 0, -1), atol=1e-9)
    assert TA[2, 3] == pytest.approx(T1[2, 3] - 0.08)
    # the gripper turned by 30 deg before entering and faces the plantlet
    step = TA[:2, 3] - T1[:2, 3]
    assert abs(np.degrees(np.arctan2(step[1], step[0]))) == pytest.approx(30, abs=1e-6)
    assert np.linalg.norm(step) == pytest.approx(STUDY.plantlet_m)


def test_cycle_is_one_unbroken_motion() -> None:
    t, q = CYCLE.joined(STUDY.pause_s, STUDY.step_s)
    assert (np.diff(t) > 0).all()
    assert np.abs(np.diff(q, axis=0)).max() < np.radians(3)
    assert ARM.chain.within_limits(q)
    carry = next(leg.motion for leg in CYCLE.legs if leg.kind == "carry")
    assert carry.t_s[-1] == pytest.approx(3.0) and np.diff(carry.t_s).max() == pytest.approx(0.025)
    np.testing.assert_allclose(carry.qdd[[0, -1]], 0, atol=1e-9)


def test_nothing_touches_a_bottle_and_a_narrow_neck_is_noticed() -> None:
    bodies = moving_bodies(plantlet_model(ARM), PlantletArmConfig())
    _, clearance = clearance_table(CYCLE, ARM, bodies)
    assert clearance > 0.004
    narrow = STUDY.model_copy(update={"bottle": BottleConfig(neck_radius_m=0.012)})
    _, tight = clearance_table(plan_cycle(ARM, narrow), ARM, bodies)
    assert tight < 0


def test_bottle_clearance_by_hand() -> None:
    bottle = Bottle(np.array([0.1, 0.2, 0.3]), BottleConfig())
    c = bottle.config
    axis = bottle.mouth_m - np.array([0, 0, c.neck_height_m / 2])
    wall = axis + np.array([c.neck_radius_m + c.glass_m / 2, 0, 0])
    outside = axis + np.array([c.neck_radius_m + c.glass_m + 0.01, 0, 0])
    d = bottle.clearance(np.stack([axis, wall, outside, bottle.mouth_m + np.array([0, 0, 0.5])]))
    assert d[0] == pytest.approx(c.neck_radius_m)
    assert d[1] < 0
    assert d[2] == pytest.approx(0.01)
    assert d[3] == pytest.approx(np.hypot(0.5, c.neck_radius_m))
    cylinder = plantlet_model(ARM).solids[1][0]
    assert np.allclose(
        np.hypot(*np.delete(surface_points(cylinder) - cylinder.T[:3, 3], 0, axis=1).T), cylinder.radius_m
    )


def test_fit_gives_the_sources_share_and_calibration_recovers_the_arm() -> None:
    rng = np.random.default_rng(3)
    targets = carrying_targets(ARM, CYCLE)
    truth = fit_errors(
        draw_errors(ARM, STUDY, rng), STUDY, targets.positions, targets.commands, targets.directions, rng
    )
    fresh = rng.standard_normal((3, 4000, 5))
    e = tip_errors(truth, targets.positions, targets.commands, targets.directions, fresh)
    assert share_within(e, STUDY.tolerance_m) == pytest.approx(0.90, abs=0.015)
    found = calibrate(truth, STUDY, rng)
    assert found.rms_after_m < found.rms_before_m
    # the fitted model predicts the repeatable error at poses it has not seen
    q = rng.uniform(-1.5, 1.5, (50, 5))
    still = np.zeros_like(q)
    gap = found.model.tool_m(q, still + 1, still) - truth.tool_m(q, still + 1, still)
    blind = ARM.chain.forward(q)[:, :3, 3] - truth.tool_m(q, still + 1, still)
    assert np.linalg.norm(gap, axis=1).mean() < 0.35 * np.linalg.norm(blind, axis=1).mean()


def test_perfect_knowledge_leaves_only_the_encoder() -> None:
    rng = np.random.default_rng(1)
    truth = draw_errors(ARM, STUDY, rng).scaled(20.0)
    for name, q in CYCLE.points.items():
        direction = rng.choice([-1.0, 1.0], 5)
        command = compensated(truth, q, direction)
        miss = truth.tool_m(command, direction, np.zeros(5))[0] - ARM.chain.forward(q)[:3, 3]
        plain = truth.tool_m(q, direction, np.zeros(5))[0] - ARM.chain.forward(q)[:3, 3]
        assert np.linalg.norm(miss) < 1.2e-4 < np.linalg.norm(plain), name


def test_compensation_beats_plain_control_and_keeps_the_aim() -> None:
    rng = np.random.default_rng(8)
    c = compare(ARM, STUDY, carrying_targets(ARM, CYCLE), 1000, rng)
    assert share_within(c.plain, STUDY.tolerance_m) == pytest.approx(0.90, abs=0.03)
    assert share_within(c.compensated, STUDY.tolerance_m) > 0.98


def test_length_errors_move_the_tool_as_they_should() -> None:
    q = CYCLE.points["P1"]
    ideal = ARM.chain.forward(q)
    taller = built_chain(ARM, np.array([0.01, 0, 0, 0, 0, 0])).forward(q)
    longer = built_chain(ARM, np.array([0, 0, 0, 0, 0, 0.01])).forward(q)
    np.testing.assert_allclose(taller[:3, 3] - ideal[:3, 3], (0, 0, 0.01), atol=1e-12)
    np.testing.assert_allclose(longer[:3, 3] - ideal[:3, 3], 0.01 * ideal[:3, 2], atol=1e-12)


def test_way_point_out_of_reach_is_one_clear_line() -> None:
    far = STUDY.model_copy(update={"wrist_p4_m": (0.9, 0.0, 0.15)})
    with pytest.raises(RobotError, match=r"way point P4 cannot be reached.*covers"):
        plan_cycle(ARM, far)


def test_the_study_writes_its_report(tmp_path: Path) -> None:
    outcome = run_plantlet_study(tmp_path, trials=60, quick=True)
    assert outcome.clearance_m > 0.004
    assert outcome.compensated_share > outcome.plain_share
    for name in (
        "README.md",
        "motion.mcap",
        "cycle.png",
        "errors.png",
        "end_points.csv",
        "line.csv",
        "sensitivity.csv",
    ):
        assert (tmp_path / name).stat().st_size > 100
