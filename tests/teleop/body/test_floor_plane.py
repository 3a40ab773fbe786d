"""The floor is found with tilt and height, and is not invented."""

import numpy as np
import pytest

from teleop.body.floor import find_floor
from teleop.body.grid import cloud, decimate
from teleop.config.body import FloorConfig
from teleop.frames import Camera, DepthFrame, kinect_v1


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


def seen(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A cloud of which everything may be floor."""
    return points, np.ones(len(points), bool)


@pytest.mark.parametrize(("tilt_deg", "height_m"), [(0, 1.0), (15, 0.7), (-15, 1.4), (5, 2.0)])
def test_tilt_and_height(tilt_deg: float, height_m: float) -> None:
    floor = find_floor(*seen(scene(tilt_deg, height_m, 0)), None, FloorConfig())
    assert floor is not None
    true = np.array([0, np.cos(np.radians(tilt_deg)), np.sin(np.radians(tilt_deg))])
    assert np.degrees(np.arccos(min(1.0, floor.normal @ true))) < 1.0
    assert floor.camera_height_m == pytest.approx(height_m, abs=0.035)


def test_previous_plane_is_smoothed_and_equal_input_gives_equal_output() -> None:
    config = FloorConfig()
    first = find_floor(*seen(scene(4, 1.0, 0)), None, config)
    again = find_floor(*seen(scene(4, 1.0, 0)), None, config)
    assert first is not None and again is not None
    assert (first.normal == again.normal).all()
    moved = find_floor(*seen(scene(4, 1.03, 1)), first, config)
    assert moved is not None
    assert first.camera_height_m < moved.camera_height_m < 1.025


def test_no_floor_where_only_a_person_is_seen() -> None:
    points = scene(0, 1.0, 0)[5500:]
    assert find_floor(*seen(points), None, FloorConfig()) is None


def room(tilt_deg: float, wall_m: float, seed: int) -> DepthFrame:
    """A bare floor 1 m below a sensor that looks down by tilt_deg, and a wall, with a Kinect's noise."""
    camera = Camera(kinect_v1(640, 480))
    k = camera.depth
    v, u = np.mgrid[: k.height, : k.width]
    x, y = (u - k.cx) / k.fx, -(v - k.cy) / k.fy
    a = np.radians(tilt_deg)
    up, ahead = np.cos(a) * y - np.sin(a), np.sin(a) * y + np.cos(a)
    with np.errstate(divide="ignore"):
        z_m = np.minimum(np.where(up < 0, -1.0 / up, np.inf), wall_m / ahead)
    z_m += np.random.default_rng(seed).normal(0.0, 1.0, x.shape) * 0.0014 * z_m**2
    return DepthFrame(0, np.round(z_m * 1000).astype(np.uint16), camera)


@pytest.mark.parametrize(("tilt_deg", "wall_m"), [(0, 3.0), (4, 4.2), (12, 3.5)])
def test_the_foot_of_a_wall_does_not_tilt_the_floor(tilt_deg: float, wall_m: float) -> None:
    grid = decimate(room(tilt_deg, wall_m, 1), 160)
    floor = find_floor(*cloud(grid, 0.5, 5.0), None, FloorConfig())
    assert floor is not None
    true = np.array([0.0, np.cos(np.radians(tilt_deg)), -np.sin(np.radians(tilt_deg))])
    assert np.degrees(np.arccos(min(1.0, floor.normal @ true))) < 0.25
    assert floor.camera_height_m == pytest.approx(1.0, abs=0.01)


def test_only_level_surfaces_may_be_floor() -> None:
    grid = decimate(room(0, 3.0, 2), 160)
    points, level = cloud(grid, 0.5, 5.0)
    assert len(points) == len(level) == grid.depth_mm.size
    assert level.sum() > 1000 and (abs(points[level, 1] + 1.0) < 0.08).mean() > 0.95
    assert not cloud(grid, 3.2, 5.0)[1].any()


def test_what_is_seen_far_below_a_desk_shows_that_the_desk_is_no_floor() -> None:
    rng = np.random.default_rng(3)
    desk = np.stack([rng.uniform(-0.6, 0.6, 900), np.full(900, -0.4), rng.uniform(0.6, 1.4, 900)], 1)
    front = np.stack([rng.uniform(-1.5, 1.5, 900), rng.uniform(-1.1, -0.6, 900), np.full(900, 2.5)], 1)
    points = (np.concatenate([desk, front]) + rng.normal(0, 0.002, (1800, 3))).astype(np.float32)
    level = np.arange(len(points)) < len(desk)
    assert find_floor(points[level], level[level], None, FloorConfig()) is not None
    assert find_floor(points, level, None, FloorConfig()) is None


@pytest.mark.parametrize(("deep_m", "told"), [(0.15, False), (1.0, True)])
def test_a_thin_strip_of_floor_does_not_tell_its_tilt(deep_m: float, told: bool) -> None:
    rng = np.random.default_rng(4)
    strip = np.stack([rng.uniform(-1.5, 1.5, 400), np.full(400, -1.0), rng.uniform(2.4, 2.4 + deep_m, 400)], 1)
    points = (strip + rng.normal(0, 0.005, (400, 3))).astype(np.float32)
    assert (find_floor(*seen(points), None, FloorConfig()) is not None) == told
