"""Temporal filter: a jump gate, then One-Euro smoothing of each joint (Casiez, Roussel, Vogel 2012)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from teleop.config.body import FilterConfig
from teleop.joints import N_JOINTS


@dataclass(frozen=True, slots=True, eq=False)
class FilterState:
    """What the filter remembers. joints_m, velocity_m_s: (20, 3), NaN while unknown. gated_s: (20,) time since the
    last accepted measurement. confidence: (20,) of that measurement."""

    joints_m: npt.NDArray[np.float64]
    velocity_m_s: npt.NDArray[np.float64]
    gated_s: npt.NDArray[np.float64]
    confidence: npt.NDArray[np.float64]


def empty_state() -> FilterState:
    """A filter that has seen nothing."""
    unknown = np.full((N_JOINTS, 3), np.nan)
    return FilterState(unknown, np.zeros((N_JOINTS, 3)), np.full(N_JOINTS, np.inf), np.zeros(N_JOINTS))


def smoothing_factor(cutoff_hz: npt.ArrayLike, dt_s: float) -> npt.NDArray[np.float64]:
    """Weight of the new value in a first-order low pass sampled every dt_s."""
    r = 2.0 * np.pi * np.asarray(cutoff_hz, dtype=np.float64) * dt_s
    return r / (r + 1.0)


def filter_step(
    joints_m: npt.NDArray[np.float64],
    confidence: npt.NDArray[np.float64],
    dt_s: float,
    state: FilterState,
    config: FilterConfig,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], FilterState]:
    """One step. joints_m: (20, 3) measured, NaN unknown. Returns joints, confidence and the next state.

    A joint that moves faster than a body can, or is not measured, is held for ``hold_s`` with falling confidence;
    then a measurement is believed where it is and a missing joint becomes unknown.
    """
    known = ~np.isnan(state.joints_m[:, 0])
    measured = ~np.isnan(joints_m[:, 0])
    waiting_s = state.gated_s + dt_s
    with np.errstate(invalid="ignore"):
        jump_m = np.linalg.norm(joints_m - state.joints_m, axis=1)
        near = jump_m <= config.gate_margin_m + config.max_speed_m_s * dt_s
    expired = waiting_s > config.hold_s
    accept = measured & (~known | near | expired)
    fresh = accept & (~known | ~near)
    smooth = accept & ~fresh
    held = known & ~accept & ~expired

    out = np.full_like(joints_m, np.nan)
    velocity = np.zeros_like(state.velocity_m_s)
    out[fresh] = joints_m[fresh]
    out[held] = state.joints_m[held]
    if smooth.any():
        raw = (joints_m[smooth] - state.joints_m[smooth]) / dt_s
        a = smoothing_factor(config.derivative_cutoff_hz, dt_s)
        velocity[smooth] = state.velocity_m_s[smooth] + a * (raw - state.velocity_m_s[smooth])
        speed = np.linalg.norm(velocity[smooth], axis=1)
        b = smoothing_factor(config.min_cutoff_hz + config.beta * speed, dt_s)[:, None]
        out[smooth] = state.joints_m[smooth] + b * (joints_m[smooth] - state.joints_m[smooth])
    gated_s = np.where(accept, 0.0, waiting_s)
    fading = np.clip(1.0 - waiting_s / config.hold_s, 0.0, 1.0)
    shown = np.where(accept, confidence, np.where(held, state.confidence * fading, 0.0))
    kept = np.where(accept, confidence, np.where(held, state.confidence, 0.0))
    return out, shown, FilterState(out, velocity, gated_s, kept)
