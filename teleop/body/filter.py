"""Temporal filter: a jump gate, then One-Euro smoothing of each joint (Casiez, Roussel, Vogel 2012)."""

from __future__ import annotations

from dataclasses import dataclass

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.config.body import FilterConfig
from teleop.joints import N_JOINTS

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class FilterState:
    """What the filter remembers. joints_m, velocity_m_s: (20, 3), NaN while unknown. gated_s: (20,) time since the
    last accepted measurement. confidence: (20,) of that measurement."""

    joints_m: Floats
    velocity_m_s: Floats
    gated_s: Floats
    confidence: Floats


def empty_state() -> FilterState:
    """A filter that has seen nothing."""
    unknown = np.full((N_JOINTS, 3), np.nan)
    return FilterState(unknown, np.zeros((N_JOINTS, 3)), np.full(N_JOINTS, np.inf), np.zeros(N_JOINTS))


@nb.njit(cache=True, nogil=True)
def smoothing_factor(cutoff_hz: float, dt_s: float) -> float:
    """Weight of the new value in a first-order low pass sampled every dt_s."""
    r = 2.0 * np.pi * cutoff_hz * dt_s
    return float(r / (r + 1.0))


@nb.njit(cache=True, nogil=True)
def _step(
    joints_m: Floats,
    confidence: Floats,
    dt_s: float,
    last_m: Floats,
    last_velocity_m_s: Floats,
    last_gated_s: Floats,
    last_confidence: Floats,
    most_m: float,
    hold_s: float,
    cutoffs: tuple[float, float, float],
) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """filter_step with the state's arrays; most_m: the way a joint may jump. cutoffs: lowest [Hz], beta, derivative's
    [Hz]. Returns joints, velocity, gated_s, confidence shown and kept."""
    min_cutoff_hz, beta, derivative_cutoff_hz = cutoffs
    out, velocity = np.full_like(joints_m, np.nan), np.zeros_like(last_velocity_m_s)
    gated_s, shown, kept = np.zeros(len(out)), np.zeros(len(out)), np.zeros(len(out))
    a = smoothing_factor(derivative_cutoff_hz, dt_s)
    for j in range(len(out)):
        known, measured = not np.isnan(last_m[j, 0]), not np.isnan(joints_m[j, 0])
        waiting_s = last_gated_s[j] + dt_s
        expired = waiting_s > hold_s
        near = np.linalg.norm(joints_m[j] - last_m[j]) <= most_m  # False where either is unknown
        if measured and (not known or near or expired):
            shown[j] = kept[j] = confidence[j]
            if not (known and near):
                out[j] = joints_m[j]
                continue
            velocity[j] = last_velocity_m_s[j] + a * ((joints_m[j] - last_m[j]) / dt_s - last_velocity_m_s[j])
            b = smoothing_factor(min_cutoff_hz + beta * float(np.linalg.norm(velocity[j])), dt_s)
            out[j] = last_m[j] + b * (joints_m[j] - last_m[j])
            continue
        gated_s[j] = waiting_s
        if known and not expired:
            out[j] = last_m[j]
            shown[j], kept[j] = last_confidence[j] * (1.0 - waiting_s / hold_s), last_confidence[j]
    return out, velocity, gated_s, shown, kept


def filter_step(
    joints_m: Floats, confidence: Floats, dt_s: float, state: FilterState, config: FilterConfig
) -> tuple[Floats, Floats, FilterState]:
    """One step. joints_m: (20, 3) measured, NaN unknown. Returns joints, confidence and the next state.

    A joint that moves faster than a body can, or is not measured, is held for ``hold_s`` with falling confidence;
    then a measurement is believed where it is and a missing joint becomes unknown.
    """
    most_m = config.gate_margin_m + config.max_speed_m_s * dt_s
    cutoffs = (config.min_cutoff_hz, config.beta, config.derivative_cutoff_hz)
    last = (state.joints_m, state.velocity_m_s, state.gated_s, state.confidence)
    out, velocity, gated_s, shown, kept = _step(joints_m, confidence, dt_s, *last, most_m, config.hold_s, cutoffs)
    return out, shown, FilterState(out, velocity, gated_s, kept)
