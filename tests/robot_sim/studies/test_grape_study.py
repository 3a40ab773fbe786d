"""The grape study: bunches, camera errors, plans that hold, trials that fail when they should."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from robot_sim.arms.config import GrapeArmConfig
from robot_sim.arms.rb03 import TOOL_JOINTS, grape_arm, grape_model
from robot_sim.arms.urdf_writer import write_urdf
from robot_sim.collision import CollisionWorld
from robot_sim.planner import FieldConfig
from robot_sim.studies.config import GrapeStudyConfig
from robot_sim.studies.grape import run_grape_study, start_configuration
from robot_sim.studies.grape_motion import pick_motion
from robot_sim.studies.grape_plan import approaches, level_pose, window
from robot_sim.studies.grape_scene import GrapeScene, camera_error, make_bunch, make_scene, seen_scene
from robot_sim.studies.grape_tables import wilson
from robot_sim.studies.grape_trial import PickWorld, find_plan, run_pick

ARM_CONFIG, STUDY = GrapeArmConfig(), GrapeStudyConfig()
ARM = grape_arm(ARM_CONFIG)


@pytest.fixture(scope="module")
def at() -> Iterator[PickWorld]:
    with CollisionWorld(write_urdf(grape_model(ARM, ARM_CONFIG))) as world:
        yield PickWorld(world, ARM, ARM_CONFIG, STUDY, FieldConfig(), start_configuration(ARM, STUDY))


def test_bunches_have_the_sources_sizes() -> None:
    rng = np.random.default_rng(0)
    for _ in range(40):
        b = make_bunch(STUDY, np.array([0.5, 0.1, 0.2]), 0.08, rng)
        v = b.volume
        assert 0.15 < v.height_m < 0.245
        assert 0.100 < 2 * v.radius_m < 0.155
        assert (b.berries_m[:, 2] + b.radii_m).max() == pytest.approx(0.2)
        d, _ = v.distance(b.berries_m)
        assert (d + b.radii_m).max() < 1e-9


def test_pairs_hang_side_by_side_from_one_cane() -> None:
    for k in range(30):
        scene = make_scene(STUDY, True, np.random.default_rng(k))
        a, b = scene.bunches
        gap = np.linalg.norm(a.top_m[:2] - b.top_m[:2])
        assert 0.79 < gap / (a.volume.radius_m + b.volume.radius_m) < 1.06
        assert a.top_m[2] + a.peduncle_m == pytest.approx(b.top_m[2] + b.peduncle_m)


def test_camera_errors_have_the_sources_means_and_shrink_with_looks() -> None:
    at_m = np.array([0.3, 0.4, 0.1])
    bearing = np.array([0.6, 0.8])
    means = {}
    for looks in (1, 4):
        rng = np.random.default_rng(looks)
        e = np.array([camera_error(STUDY, False, at_m, looks, rng) for _ in range(4000)])
        seen = np.stack([e[:, 1] * bearing[0] - e[:, 0] * bearing[1], e[:, :2] @ bearing, e[:, 2]], axis=1)
        means[looks] = np.abs(seen).mean(axis=0) * 1e3
    np.testing.assert_allclose(means[1], STUDY.single_error_mm, rtol=0.05)
    np.testing.assert_allclose(means[4], means[1] / 2, rtol=0.06)
    scene = make_scene(STUDY, False, np.random.default_rng(0))
    assert seen_scene(scene, STUDY, 0, np.random.default_rng(0))[0] is scene


def test_tool_pose_is_level_and_the_tray_hangs_below() -> None:
    T = level_pose(np.array([0.5, 0.1, 0.2]), 0.4)
    np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-12)
    assert np.linalg.det(T[:3, :3]) == pytest.approx(1.0)
    np.testing.assert_allclose(T[:3, 1], (0, 0, -1))


def test_approaches_are_sorted_and_inside_the_window() -> None:
    scene = make_scene(STUDY, True, np.random.default_rng(4))
    found = approaches(scene, ARM_CONFIG, STUDY)
    assert len({a.bunch for a in found}) == 2
    low, high = window(scene.bunches[found[0].bunch], ARM_CONFIG)
    assert low + STUDY.margin_h1_m - 1e-12 <= found[0].height_m <= max(high, low + STUDY.margin_h1_m)


def test_exactly_seen_bunches_are_picked(at: PickWorld) -> None:
    outcomes = []
    for k in range(6):
        scene = make_scene(STUDY, bool(k % 2), np.random.default_rng((1, k)))
        outcomes.append(run_pick(at, scene, scene)[0])
    assert sum(o.success for o in outcomes) >= 5, [o.failure for o in outcomes]
    for o in outcomes:
        if o.success:
            assert o.key_points >= 8 and 0.5 < o.path_m < 3.0
            assert 20 <= o.tray_deg <= 90


def lowered(scene: GrapeScene, by_m: float) -> GrapeScene:
    """The scene as a camera sees it that puts everything too low by this much."""
    down = np.array([0.0, 0.0, -by_m])
    return GrapeScene(tuple(b.moved(down) for b in scene.bunches), scene.cane, scene.post)


def test_a_bunch_seen_too_low_is_touched_and_counts_as_failure(at: PickWorld) -> None:
    failures = []
    for k in range(4):
        scene = make_scene(STUDY, False, np.random.default_rng((2, k)))
        failures.append(run_pick(at, scene, lowered(scene, 0.030), height_m=0.020)[0])
    assert any(o.collision for o in failures)
    assert not any(o.success for o in failures)


def test_a_peduncle_beside_the_fingers_is_not_clamped(at: PickWorld) -> None:
    scene = make_scene(STUDY, False, np.random.default_rng((1, 0)))
    bearing = np.arctan2(scene.bunches[0].top_m[1], scene.bunches[0].top_m[0])
    aside = 0.07 * np.array([-np.sin(bearing), np.cos(bearing), 0.0])
    seen = GrapeScene((scene.bunches[0].moved(aside),), scene.cane, scene.post)
    outcome, _ = run_pick(at, scene, seen)
    assert not outcome.success
    assert outcome.failure.startswith(("clamp", "touch")), outcome.failure


def test_the_motion_runs_through_the_plan_inside_the_speed_limits(at: PickWorld) -> None:
    scene = make_scene(STUDY, False, np.random.default_rng((1, 0)))
    at.clear()
    plan, reason, _ = find_plan(at, scene)
    assert plan is not None, reason
    m = pick_motion(ARM_CONFIG, STUDY, plan, 45.0)
    assert (np.diff(m.t_s) > 0).all()
    speed = np.abs(np.diff(m.q, axis=0)) / np.diff(m.t_s)[:, None]
    assert speed.max() <= ARM.chain.speed.max() * 1.01
    tool = ARM.chain.forward(m.q)[:, :3, 3]
    np.testing.assert_allclose(tool[0], STUDY.start_m, atol=1e-6)
    np.testing.assert_allclose(tool[-1], STUDY.basket_m, atol=1e-4)
    grip = scene.bunches[plan.approach.bunch].top_m + np.array([0, 0, plan.approach.height_m])
    assert np.linalg.norm(tool - grip, axis=1).min() < 1e-4
    assert m.tool.shape == (len(m.t_s), len(TOOL_JOINTS))


def test_wilson_interval_by_hand() -> None:
    low, high = wilson(16, 18)
    assert low == pytest.approx(0.672, abs=0.002) and high == pytest.approx(0.969, abs=0.002)
    assert wilson(0, 0) == (0.0, 1.0)


def test_the_study_writes_its_report(tmp_path: Path) -> None:
    outcome = run_grape_study(tmp_path, trials=4, quick=True)
    assert outcome.first_successes >= 16
    names = ("README.md", "motion.mcap", "trials_18.csv", "success.csv", "margin.csv", "planners.csv", "pick.png")
    for name in (*names, "pick_carried.png", "summary.png"):
        assert (tmp_path / name).stat().st_size > 100
    assert "88.89" in outcome.page.read_text(encoding="utf-8")
