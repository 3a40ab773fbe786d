"""Refusal of joints that are not numbers or move faster than a body can."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.config.intent import SafetyConfig
from teleop.joints import JOINT_INDEX, JOINT_NAMES, N_JOINTS
from teleop.reasons import Reason
from teleop.skeleton import Skeleton

TRUNK: Final = np.array(
    [any(word in name for word in ("spine", "hip", "shoulder", "head")) for name in JOINT_NAMES], dtype=np.bool_
)
SPINE: Final = JOINT_INDEX["spine"]


@dataclass(frozen=True, slots=True, eq=False)
class JumpState:
    """Where every joint was last believed: joints_m (20, 3) and age_s (20,), the time since."""

    joints_m: npt.NDArray[np.float64]
    age_s: npt.NDArray[np.float64]


def initial_jumps() -> JumpState:
    """Nothing believed yet."""
    return JumpState(np.full((N_JOINTS, 3), np.nan), np.zeros(N_JOINTS))


@dataclass(frozen=True, slots=True)
class Verdict:
    """operator_changed: the trunk is somewhere else for good, so it is another person."""

    reasons: tuple[Reason, ...] = ()
    operator_changed: bool = False


def step_jumps(
    state: JumpState, skeleton: Skeleton, dt_s: float, config: SafetyConfig
) -> tuple[Skeleton | None, Verdict, JumpState]:
    """One frame: the skeleton with refused joints unknown, or None when its trunk is where the operator cannot be.

    A joint is believed again as soon as it could have moved that far since it was last believed.
    """
    joints = skeleton.joints_m.copy()
    reasons: list[Reason] = []
    known: npt.NDArray[np.bool_] = np.asarray(~np.isnan(joints).any(axis=1))
    absurd = known & ~(np.isfinite(joints).all(axis=1) & (np.abs(joints).max(axis=1) <= config.max_range_m))
    doubtful = ~np.isfinite(skeleton.confidence)
    if (absurd | (known & doubtful)).any():
        reasons.append(Reason.JOINT_NOT_FINITE)
        joints[absurd | doubtful] = np.nan
        known &= ~(absurd | doubtful)
    age_s = state.age_s + dt_s
    before = ~np.isnan(state.joints_m).any(axis=1)
    with np.errstate(invalid="ignore"):
        moved_m = np.linalg.norm(joints - state.joints_m, axis=1)
    speed = np.where(TRUNK, config.trunk_speed_m_s, config.joint_speed_m_s)
    jumped: npt.NDArray[np.bool_] = np.asarray(known & before & (moved_m > config.joint_slack_m + speed * age_s))
    if jumped[SPINE] and age_s[SPINE] <= config.lost_hold_s:
        return None, Verdict((*reasons, Reason.OPERATOR_JUMP)), JumpState(state.joints_m, age_s)
    # a trunk that was refused before and is still away from where it was, beyond one frame's reach, is another's
    late = age_s[SPINE] > dt_s + 1e-9 and known[SPINE] and before[SPINE]
    away = bool(late and moved_m[SPINE] > config.joint_slack_m + config.trunk_speed_m_s * min(age_s[SPINE], 0.15))
    if away:
        return (
            Skeleton(skeleton.t_ns, joints, skeleton.confidence),
            Verdict((*reasons, Reason.OPERATOR_JUMP), operator_changed=True),
            _believe(initial_jumps(), joints, known),
        )
    if jumped.any():
        reasons.append(Reason.JOINT_JUMP)
        joints[jumped] = np.nan
        known &= ~jumped
    after = _believe(JumpState(state.joints_m, age_s), joints, known)
    return Skeleton(skeleton.t_ns, joints, np.where(known, skeleton.confidence, 0.0)), Verdict(tuple(reasons)), after


def _believe(state: JumpState, joints_m: npt.NDArray[np.float64], known: npt.NDArray[np.bool_]) -> JumpState:
    return JumpState(np.where(known[:, None], joints_m, state.joints_m), np.where(known, 0.0, state.age_s))
