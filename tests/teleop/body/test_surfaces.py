"""Surfaces are parted at depth steps and measured; pieces are joined where they belong together."""

import numpy as np

from teleop.body.components import adjacency, label_surfaces, measure_surfaces
from teleop.body.grid import decimate, standing
from teleop.body.segmentation import window_round
from teleop.config.body import SegmentationConfig
from teleop.frames import Camera, DepthFrame, kinect_v1
from teleop.skeleton import FloorPlane


def test_depth_step_parts_and_dropout_is_bridged() -> None:
    depth = np.full((20, 30), 2000, np.uint16)
    depth[:, 15:] = 2500
    usable = np.ones((20, 30), bool)
    usable[:, 7] = False
    labels, count = label_surfaces(depth, usable, 0.07)
    assert count == 2
    assert (labels[:, 7] == -1).all()
    assert len(set(labels[:, :7].ravel()) | set(labels[:, 8:15].ravel())) == 1
    assert labels[0, 0] != labels[0, 20]


def test_measures() -> None:
    depth = np.full((10, 10), 2000, np.uint16)
    labels = np.zeros((10, 10), np.int32)
    v, u = np.mgrid[:10, :10].astype(np.float32)
    points = np.stack([u * 0.1, v * 0.1, np.full_like(u, 2.0)], axis=2)
    person = np.full((10, 10), 0.25, np.float32)
    s = measure_surfaces(labels, points, depth, person, 1, 0.05)
    assert s.cells[0] == 100
    np.testing.assert_allclose(s.area_m2, 100 * (0.05 * 2) ** 2)
    np.testing.assert_allclose(s.high_m[0] - s.low_m[0], [0.9, 0.9, 0], atol=1e-6)
    np.testing.assert_allclose(s.person, 0.25)
    np.testing.assert_allclose(measure_surfaces(labels, points, depth, None, 1, 0.05).person, 1.0)


def test_adjacency_counts_touching_cells() -> None:
    labels = np.full((5, 8), -1, np.int32)
    labels[:, 0:2], labels[:, 3:5], labels[0, 7] = 0, 1, 2
    near = adjacency(labels, 0, 3, 2)
    assert near.tolist() == [0, 5, 0]


def test_what_stands_is_above_the_floor() -> None:
    camera = Camera(kinect_v1(320, 240))
    grid = decimate(DepthFrame(0, np.full((240, 320), 2000, np.uint16), camera), 160)
    assert grid.step == 2 and grid.depth_mm.shape == (120, 160)
    floor = FloorPlane(np.array([0.0, 1.0, 0.0]), 0.5)
    usable, levelled = standing(grid, 0.5, 5.0, floor, 0.05)
    np.testing.assert_allclose(levelled[..., 1], np.broadcast_to(2.0 * grid.up[:, None] + 0.5, (120, 160)), atol=1e-6)
    assert (usable == (levelled[..., 1] > 0.05)).all()
    everything, _ = standing(grid, 0.5, 5.0, None, 0.05)
    assert everything.all()


def test_people_are_looked_for_where_the_operator_can_have_come() -> None:
    camera, config = Camera(kinect_v1(640, 480)), SegmentationConfig()
    cells = np.zeros((120, 160), bool)
    cells[50:60, 70:80] = True

    def window(depth_m: float, dt_s: float) -> np.ndarray:
        found = window_round(cells, depth_m, dt_s, camera, config)
        assert found is not None
        return np.array(found)

    outward = np.array([-1, -1, 1, 1])
    inner, later, nearer = window(3.0, 0.033), window(3.0, 0.1), window(1.5, 0.033)
    assert (outward * (inner - [50, 70, 60, 80]) >= 0.35 * camera.depth.fx / 4 / 3.0).all()
    assert (outward * (later - inner) > 0).all() and (outward * (nearer - inner) > 0).all()
    assert (window(0.5, 5.0) == [0, 0, 120, 160]).all()
    assert window_round(np.zeros((120, 160), bool), 2.0, 0.033, camera, config) is None
