"""Figures of a tracker's answers against the truth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.angles import body_angles
from teleop.config.intent import AngleConfig
from teleop.skeleton import Skeleton

NEAR_M: Final = 0.10
"""A joint nearer to the truth than this is found (Shotton 2011)."""
ANGLES: Final = (
    "theta1_right",
    "theta2_right",
    "theta3_right",
    "theta1_left",
    "theta2_left",
    "theta3_left",
    "T1",
    "T2",
)
Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class JointFigures:
    """Per joint (J,): how many truths counted, share answered, share within 10 cm of the truth (unanswered counts as
    wrong), mean and median error [m] of the answered, average precision at 10 cm."""

    count: npt.NDArray[np.int64]
    answered: Floats
    near: Floats
    mean_m: Floats
    median_m: Floats
    precision: Floats


def joint_figures(found_m: Floats, confidence: Floats, truth_m: Floats, counted: Bools) -> JointFigures:
    """Figures of answers (F, J, 3), NaN unknown, with confidence (F, J), where ``counted`` (F, J)."""
    error = np.linalg.norm(found_m - truth_m, axis=2)
    joints = error.shape[1]
    out = [np.full(joints, np.nan) for _ in range(5)]
    for j in range(joints):
        e = error[counted[:, j], j]
        if len(e) == 0:
            continue
        known = ~np.isnan(e)
        out[0][j] = known.mean()
        out[1][j] = (e < NEAR_M).sum() / len(e)
        if known.any():
            out[2][j], out[3][j] = e[known].mean(), np.median(e[known])
        out[4][j] = average_precision(error[:, j] < NEAR_M, confidence[:, j], ~np.isnan(error[:, j]), counted[:, j])
    return JointFigures(counted.sum(axis=0), *out)


def average_precision(near: Bools, confidence: Floats, answered: Bools, present: Bools) -> float:
    """Area under precision over recall of one joint's answers (F,), surest first.

    An answer where no joint is to be seen is a false one only when it is not near the hidden joint (Shotton 2011
    counts visible joints; a right guess of a hidden one is not punished).
    """
    judged = answered & (present | ~near)
    order = np.argsort(-confidence[judged], kind="stable")
    hits = (near & present)[judged][order]
    total = int(present.sum())
    if total == 0 or len(hits) == 0:
        return 0.0
    precision = np.cumsum(hits) / np.arange(1, len(hits) + 1)
    return float(precision[hits].sum() / total)


def body_angles_deg(joints_m: Floats, visible: Bools, config: AngleConfig) -> Floats:
    """Angles (F, 8) of ANGLES in degrees from joints (F, 20, 3); NaN where a joint is not ``visible`` or unknown."""
    rows = []
    for joints, seen in zip(joints_m, visible, strict=True):
        found = body_angles(Skeleton(0, np.where(seen[:, None], joints, np.nan), np.ones(len(seen))), config)
        arms = (found.right, found.left)
        values = [v for arm in arms for v in (arm.theta1_deg, arm.theta2_deg, arm.theta3_deg)]
        rows.append([np.nan if v is None else v for v in (*values, found.T1_deg, found.T2_deg)])
    return np.array(rows, dtype=np.float64)
