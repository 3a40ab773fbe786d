"""Jump gate and One-Euro filter."""

import numpy as np
import pytest

from teleop.body.filter import empty_state, filter_step, smoothing_factor
from teleop.config.body import FilterConfig
from teleop.joints import N_JOINTS

DT = 1 / 30


def run(track: np.ndarray, config: FilterConfig) -> np.ndarray:
    """Feed (F, 3) positions to joint 0, others unknown."""
    state, out = empty_state(), []
    for p in track:
        joints = np.full((N_JOINTS, 3), np.nan)
        joints[0] = p
        shown, confidence, state = filter_step(joints, np.ones(N_JOINTS), DT, state, config)
        assert np.isnan(shown[1:]).all()
        assert ((confidence >= 0) & (confidence <= 1)).all()
        out.append(shown[0])
    return np.array(out)


def test_first_measurement_passes_and_noise_at_rest_shrinks() -> None:
    rng = np.random.default_rng(0)
    noisy = np.array([0.1, 0.2, 2.0]) + rng.normal(0, 0.01, (200, 3))
    out = run(noisy, FilterConfig())
    assert (out[0] == noisy[0]).all()
    assert out[50:].std(axis=0).max() < 0.7 * noisy[50:].std(axis=0).max()


def test_fast_motion_lags_little() -> None:
    t = np.arange(60) * DT
    track = np.stack([1.5 * t, np.zeros(60), np.full(60, 2.0)], 1)
    out = run(track, FilterConfig())
    assert abs(out[-1, 0] - track[-1, 0]) < 0.05


def test_jump_is_gated_then_believed() -> None:
    config = FilterConfig()
    track = np.tile([0.0, 0.0, 2.0], (40, 1))
    track[20:] = [1.0, 0.0, 2.0]
    out = run(track, config)
    assert np.abs(out[20] - out[19]).max() < 1e-9
    held = int(np.ceil(config.hold_s / DT)) + 1
    np.testing.assert_allclose(out[20 + held], track[-1])


def test_single_outlier_never_shows() -> None:
    track = np.tile([0.0, 0.0, 2.0], (30, 1))
    track[15] = [0.8, 0.5, 2.0]
    np.testing.assert_allclose(run(track, FilterConfig()), np.tile([0.0, 0.0, 2.0], (30, 1)), atol=1e-12)


def test_missing_joint_is_held_then_unknown() -> None:
    track = np.tile([0.0, 0.0, 2.0], (30, 1))
    track[10:] = np.nan
    out = run(track, FilterConfig())
    assert not np.isnan(out[11]).any()
    assert np.isnan(out[25]).all()


def test_smoothing_factor_is_a_low_pass() -> None:
    assert float(smoothing_factor(1.0, DT)) == pytest.approx(2 * np.pi * DT / (1 + 2 * np.pi * DT))
    assert float(smoothing_factor(1000.0, DT)) > 0.99
