"""Many exponentials at once are those of the library."""

import numpy as np

from teleop.body.exponent import exp_in_place


def test_exponentials_are_right_and_cut_off_at_both_ends() -> None:
    x = np.concatenate([np.linspace(-87, 87, 100_001), [0.0, -1e9, 1e9]]).astype(np.float32)
    values = x.copy()
    exp_in_place(values, np.empty(len(x), np.int32))
    wanted = np.exp(x[:-2].astype(np.float64))
    np.testing.assert_allclose(values[:-2], wanted, rtol=5e-6)
    near = abs(x[:-2]) < 1
    np.testing.assert_allclose(values[:-2][near], wanted[near], rtol=3e-7)
    assert 0 < values[-2] < 1e-37 and 1e37 < values[-1] < np.inf
