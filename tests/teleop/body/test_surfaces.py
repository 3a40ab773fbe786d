"""Surfaces are parted at depth steps and measured; pieces are joined where they belong together."""

import numpy as np

from teleop.body.components import adjacency, grow_mask, label_surfaces, measure_surfaces


def test_depth_step_parts_and_dropout_is_bridged() -> None:
    depth = np.full((20, 30), 2.0, np.float32)
    depth[:, 15:] = 2.5
    usable = np.ones((20, 30), bool)
    usable[:, 7] = False
    labels, count = label_surfaces(depth, usable, 0.07)
    assert count == 2
    assert (labels[:, 7] == -1).all()
    assert len(set(labels[:, :7].ravel()) | set(labels[:, 8:15].ravel())) == 1
    assert labels[0, 0] != labels[0, 20]


def test_measures() -> None:
    depth = np.full((10, 10), 2.0, np.float32)
    labels = np.zeros((10, 10), np.int32)
    v, u = np.mgrid[:10, :10].astype(np.float32)
    points = np.stack([u * 0.1, v * 0.1, depth], axis=2)
    s = measure_surfaces(labels, points, depth, 1, 0.05)
    assert s.cells[0] == 100
    np.testing.assert_allclose(s.area_m2, 100 * (0.05 * 2) ** 2)
    np.testing.assert_allclose(s.high_m[0] - s.low_m[0], [0.9, 0.9, 0], atol=1e-6)


def test_adjacency_counts_touching_cells() -> None:
    labels = np.full((5, 8), -1, np.int32)
    labels[:, 0:2], labels[:, 3:5], labels[0, 7] = 0, 1, 2
    near = adjacency(labels, 0, 3, 2)
    assert near.tolist() == [0, 5, 0]


def test_mask_follows_depth_and_cuts_below_the_floor_line() -> None:
    depth = np.full((16, 16), 2000, np.uint16)
    depth[:, 8:] = 3000
    grid = np.ascontiguousarray(depth[::4, ::4])
    chosen = grid == 2000
    free = np.array([0.0, 0.0, 0.0, 1.0])
    mask = grow_mask(depth, chosen, grid, 4, 0.07, free)
    assert (mask == (depth == 2000)).all()
    # height = 1 - v / 8 at 2 m: rows from 8 on are floor
    cut = grow_mask(depth, chosen, grid, 4, 0.07, np.array([0.0, -1 / 16, 0.0, 1.0]))
    assert cut[:8, :8].all() and not cut[8:].any()
