"""Mean shift finds the modes of a density."""

import numpy as np

from teleop.body.meanshift import find_modes, shift_to_mode


def clouds(rng: np.random.Generator) -> np.ndarray:
    a = rng.normal([0.3, 0.1, 2.0], 0.02, (200, 3))
    b = rng.normal([-0.3, 0.2, 2.2], 0.02, (80, 3))
    return np.concatenate([a, b]).astype(np.float32)


def test_two_clouds_give_two_modes_heaviest_first() -> None:
    points = clouds(np.random.default_rng(0))
    weights = np.ones(len(points), np.float32)
    modes, scores = find_modes(points.T.copy(), weights, 0.06, 3, 100, 1e-6)
    np.testing.assert_allclose(modes[0], [0.3, 0.1, 2.0], atol=0.006)
    np.testing.assert_allclose(modes[1], [-0.3, 0.2, 2.2], atol=0.01)
    assert scores[0] > 190 and 75 <= scores[1] <= 80


def test_mode_is_stationary_under_the_exact_kernel() -> None:
    rng = np.random.default_rng(2)
    points = clouds(rng)
    weights = rng.uniform(0.2, 1, len(points)).astype(np.float32)
    mode = shift_to_mode(points.T.copy(), weights, np.array([0.25, 0.1, 2.0]), 0.06, 500, 1e-7)
    kernel = weights * np.exp(-(((points - mode) / 0.06) ** 2).sum(axis=1))
    shift = (kernel[:, None] * (points - mode)).sum(axis=0) / kernel.sum()
    assert np.linalg.norm(shift) < 1e-4


def test_no_weight_no_mode() -> None:
    points = np.zeros((3, 4), np.float32)
    modes, scores = find_modes(points, np.zeros(4, np.float32), 0.06, 2, 10, 1e-4)
    assert np.isnan(modes).all()
    assert (scores == 0).all()


def test_small_weights_and_points_that_do_not_count_change_nothing() -> None:
    points, start = clouds(np.random.default_rng(4)).T.copy(), np.array([0.25, 0.06, 2.05])
    weights = np.ones(points.shape[1], np.float32)
    wanted = shift_to_mode(points, weights, start, 0.06, 100, 1e-4)
    for scale in (1e-25, 1e-33, 1e30):
        tiny = (weights * np.float32(scale)).astype(np.float32)
        np.testing.assert_allclose(shift_to_mode(points, tiny, start, 0.06, 100, 1e-4), wanted, atol=1e-5)
    modes, scores = find_modes(points, weights, 0.06, 2, 100, 1e-4)
    padded = np.concatenate([points, np.full((3, 30), np.nan, np.float32)], axis=1)
    again, same = find_modes(padded, weights, 0.06, 2, 100, 1e-4)
    np.testing.assert_array_equal(again, modes)
    np.testing.assert_array_equal(same, scores)
