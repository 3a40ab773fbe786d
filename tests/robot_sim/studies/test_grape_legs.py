"""Motions of a pick: smooth where free, straighter where a corner would be cut; the carried bunch is watched."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from robot_sim.arms.rb03 import grape_arm
from robot_sim.kinematics.transforms import FloatArray, translation
from robot_sim.studies.config import GrapeStudyConfig
from robot_sim.studies.grape_carry import carried_hit, carried_volume_hit
from robot_sim.studies.grape_legs import BETWEEN, free_leg, smooth_leg, straight_leg, swept_rows
from robot_sim.studies.grape_plan import level_pose
from robot_sim.studies.grape_scene import make_scene
from robot_sim.trajectories import Trajectory

ARM = grape_arm()
CORNER = np.radians(
    [[0, -100, 80, 0, -70, 0], [40, -100, 80, 0, -70, 0], [40, -60, 60, 0, -70, 0], [0, -60, 60, 0, -70, 0]]
)


def off_the_segments(leg: Trajectory) -> float:
    """Largest distance of a motion from the straight joint segments between the corners, rad."""
    q = leg.sample(0.01).q
    away = []
    for a, b in pairwise(CORNER):
        share = np.clip((q - a) @ (b - a) / float((b - a) @ (b - a)), 0, 1)
        away.append(np.linalg.norm(q - a - share[:, None] * (b - a), axis=1))
    return float(np.min(away, axis=0).max())


def test_more_points_between_hold_the_curve_to_the_segments() -> None:
    off = [off_the_segments(smooth_leg(ARM, CORNER, 0.25, n)) for n in BETWEEN]
    assert off[0] > 0.03
    assert off[0] > off[1] > off[2]
    straight = straight_leg(ARM, CORNER, 0.25)
    assert off_the_segments(straight) < 1e-9
    for leg in (smooth_leg(ARM, CORNER, 0.25, 3), straight):
        m = leg.sample(0.002)
        assert np.abs(m.qd).max() <= ARM.chain.speed.max() * (1 + 1e-6)
        np.testing.assert_allclose(m.q[[0, -1]], CORNER[[0, -1]], atol=1e-9)
        np.testing.assert_allclose(m.qd[[0, -1]], 0.0, atol=1e-6)


def test_a_cut_corner_makes_the_leg_straighter_and_no_more_than_it_must() -> None:
    limit = 0.5 * (off_the_segments(smooth_leg(ARM, CORNER, 0.25)) + off_the_segments(smooth_leg(ARM, CORNER, 0.25, 1)))

    def hits(allowed: float) -> tuple[float, str, bool]:
        leg, why, straighter = free_leg(ARM, CORNER, 0.25, lambda t: "wall" if off_the_segments(t) > allowed else "")
        return off_the_segments(leg), why, straighter

    assert hits(np.inf)[1:] == ("", False)
    off, why, straighter = hits(limit)
    assert (why, straighter) == ("", True) and 1e-6 < off <= limit
    assert hits(1e-6)[0] < 1e-6  # only the straight one is left
    assert hits(-1.0)[1] == "wall"


def test_swept_rows_are_as_close_as_asked() -> None:
    rows = swept_rows(ARM, smooth_leg(ARM, CORNER, 0.25), 0.01)
    p = ARM.chain.forward(rows)[:, :3, 3]
    assert np.linalg.norm(np.diff(p, axis=0), axis=1).max() < 0.014
    np.testing.assert_allclose(rows[[0, -1]], CORNER[[0, -1]], atol=1e-6)


def along(start: FloatArray, way_m: FloatArray) -> FloatArray:
    return np.array([translation(*(s * way_m)) @ start for s in np.linspace(0, 1, 30)])


def test_a_bunch_carried_through_its_neighbour_or_a_post_is_found() -> None:
    study = GrapeStudyConfig()
    scene = make_scene(study, True, np.random.default_rng(3))
    a, b = scene.bunches
    towards = b.top_m - a.top_m
    towards[2] = 0.0
    grip = level_pose(a.top_m, 0.0)
    for check in (carried_hit, carried_volume_hit):
        assert "neighbour" in check(scene, 0, along(grip, towards), study.press_m)
        assert check(scene, 0, along(grip, -0.3 * towards), study.press_m) == ""
    posted = next(s for k in range(50) if (s := make_scene(study, False, np.random.default_rng(k))).post is not None)
    assert posted.post is not None
    to_post = posted.post.centre - posted.bunches[0].top_m
    to_post[2] = 0.0
    start = level_pose(posted.bunches[0].top_m, 0.0)
    for check in (carried_hit, carried_volume_hit):
        assert "post" in check(posted, 0, along(start, to_post), study.press_m)
