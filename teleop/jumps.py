"""Refusal of joints that are not numbers or move faster than a body can."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.config.intent import SafetyConfig
from teleop.joints import JOINT_NAMES, N_JOINTS
from teleop.reasons import Reason
from teleop.skeleton import Skeleton

Mask = npt.NDArray[np.bool_]
TRUNK: Final[Mask] = np.array(
    [any(word in name for word in ("spine", "hip", "shoulder", "head")) for name in JOINT_NAMES], dtype=np.bool_
)


@dataclass(frozen=True, slots=True, eq=False)
class JumpState:
    """Where every joint was last believed: joints_m (20, 3), NaN = never, and age_s (20,), the time since."""

    joints_m: npt.NDArray[np.float64]
    age_s: npt.NDArray[np.float64]


def initial_jumps() -> JumpState:
    """Nothing believed yet."""
    return JumpState(np.full((N_JOINTS, 3), np.nan), np.zeros(N_JOINTS))


def aged(state: JumpState, dt_s: float) -> JumpState:
    """The same after some time without a skeleton."""
    return JumpState(state.joints_m, state.age_s + dt_s)


def finite_only(skeleton: Skeleton, config: SafetyConfig) -> tuple[Skeleton, bool]:
    """The skeleton with every joint unknown that is no place in the sensor's range, and whether there was one."""
    joints = skeleton.joints_m
    unknown: Mask = np.asarray(np.isnan(joints).all(axis=1))
    with np.errstate(invalid="ignore"):
        usable: Mask = np.asarray((np.abs(joints) <= config.max_range_m).all(axis=1) & np.isfinite(skeleton.confidence))
    cleaned = Skeleton(
        skeleton.t_ns, np.where(usable[:, None], joints, np.nan), np.where(usable, skeleton.confidence, 0.0)
    )
    return cleaned, bool((~usable & ~unknown).any())


def step_jumps(
    state: JumpState, skeleton: Skeleton, dt_s: float, config: SafetyConfig
) -> tuple[Skeleton, tuple[Reason, ...], JumpState]:
    """One frame: the skeleton with impossible joints unknown.

    A joint is believed again as soon as it could have moved that far since it was last believed.
    """
    skeleton, absurd = finite_only(skeleton, config)
    state = aged(state, dt_s)
    known: Mask = np.asarray(~np.isnan(skeleton.joints_m).any(axis=1))
    moved_m = np.linalg.norm(skeleton.joints_m - state.joints_m, axis=1)
    speed_m_s = np.where(TRUNK, config.trunk_speed_m_s, config.joint_speed_m_s)
    # a comparison with a joint never believed (NaN) is false: it is believed at once
    jumped: Mask = np.asarray(moved_m > config.joint_slack_m + speed_m_s * state.age_s)
    believed: Mask = known & ~jumped
    after = JumpState(
        np.where(believed[:, None], skeleton.joints_m, state.joints_m), np.where(believed, 0.0, state.age_s)
    )
    gated = Skeleton(
        skeleton.t_ns,
        np.where(believed[:, None], skeleton.joints_m, np.nan),
        np.where(believed, skeleton.confidence, 0.0),
    )
    reasons = [Reason.JOINT_NOT_FINITE] if absurd else []
    if (known & jumped).any():
        reasons.append(Reason.JOINT_JUMP)
    return gated, tuple(reasons), after
