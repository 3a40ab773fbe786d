"""The floor is found with tilt and height, and is not invented."""

import numpy as np
import pytest

from teleop.body.floor import find_floor
from teleop.config.body import FloorConfig


def scene(tilt_deg: float, height_m: float, seed: int) -> np.ndarray:
    """Floor, back wall and a person-like column, seen by a tilted sensor."""
    rng = np.random.default_rng(seed)
    floor = np.stack([rng.uniform(-2, 2, 2500), np.zeros(2500), rng.uniform(1.5, 4, 2500)], 1)
    wall = np.stack([rng.uniform(-2, 2, 3000), rng.uniform(0, 2.4, 3000), np.full(3000, 4.0)], 1)
    body = np.stack([rng.uniform(-0.25, 0.25, 1500), rng.uniform(0, 1.75, 1500), np.full(1500, 2.4)], 1)
    points = np.concatenate([floor, wall, body]) - [0, height_m, 0] + rng.normal(0, 0.006, (7000, 3))
    a = np.radians(tilt_deg)
    R = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    return (points @ R.T).astype(np.float32)


@pytest.mark.parametrize(("tilt_deg", "height_m"), [(0, 1.0), (15, 0.7), (-15, 1.4), (5, 2.0)])
def test_tilt_and_height(tilt_deg: float, height_m: float) -> None:
    floor = find_floor(scene(tilt_deg, height_m, 0), None, FloorConfig())
    assert floor is not None
    true = np.array([0, np.cos(np.radians(tilt_deg)), np.sin(np.radians(tilt_deg))])
    assert np.degrees(np.arccos(min(1.0, floor.normal @ true))) < 1.0
    assert floor.camera_height_m == pytest.approx(height_m, abs=0.035)


def test_previous_plane_is_smoothed_and_equal_input_gives_equal_output() -> None:
    config = FloorConfig()
    first = find_floor(scene(4, 1.0, 0), None, config)
    again = find_floor(scene(4, 1.0, 0), None, config)
    assert first is not None and again is not None
    assert (first.normal == again.normal).all()
    moved = find_floor(scene(4, 1.03, 1), first, config)
    assert moved is not None
    assert first.camera_height_m < moved.camera_height_m < 1.025


def test_no_floor_where_only_a_person_is_seen() -> None:
    points = scene(0, 1.0, 0)[5500:]
    assert find_floor(points, None, FloorConfig()) is None
