"""Angle figures: errors of theta1, theta2, theta3, T1, T2 in levelled axes, steps of 15 degrees, the task."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.angles import body_angles
from teleop.config.intent import AngleConfig, MappingConfig, TaskConfig
from teleop.evaluation.answers import Answers
from teleop.joints import JOINT_INDEX
from teleop.mapping import nearest_step
from teleop.skeleton import Skeleton

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


def body_angles_deg(joints_m: Floats, known: Bools, config: AngleConfig) -> Floats:
    """Angles (F, 8) of ANGLES in degrees from joints (F, 20, 3); NaN where a joint is not ``known`` (F, 20)."""
    rows = []
    for joints, seen in zip(joints_m, known, strict=True):
        found = body_angles(Skeleton(0, np.where(seen[:, None], joints, np.nan), np.ones(len(seen))), config)
        arms = (found.right, found.left)
        values = [v for arm in arms for v in (arm.theta1_deg, arm.theta2_deg, arm.theta3_deg)]
        rows.append([np.nan if v is None else v for v in (*values, found.T1_deg, found.T2_deg)])
    return np.array(rows, dtype=np.float64).reshape(-1, len(ANGLES))


def levelled(joints_m: Floats, R: Floats) -> Floats:
    """Joints (F, 20, 3) in levelled axes; R (F, 3, 3)."""
    return np.einsum("fij,fkj->fki", R, joints_m)


@dataclass(frozen=True, slots=True, eq=False)
class AnglePairs:
    """true, found: (F, 8) degrees, NaN where there is no truth, no answer. share: (F, 4) length of the upper arm's
    projection as a part of the bone, true, for theta1 and theta2 of the right, then of the left arm."""

    true: Floats
    found: Floats
    share: Floats

    def of(self, name: str) -> tuple[Floats, Floats]:
        """True and found angles (N,) of one name, or of both sides of an arm angle, where there is a truth."""
        columns = [k for k, full in enumerate(ANGLES) if full == name or full.rsplit("_", 1)[0] == name]
        true, found = self.true[:, columns].ravel(), self.found[:, columns].ravel()
        there = ~np.isnan(true)
        return true[there], found[there]


def angle_pairs(answers: Answers, config: AngleConfig) -> AnglePairs:
    """Angles of truth and answer, each levelled its own way."""
    truth = levelled(answers.truth_m, answers.level_true)
    found = levelled(answers.joints_m, answers.level_found)
    shares = []
    for side in ("right", "left"):
        bone = truth[:, JOINT_INDEX[f"elbow_{side}"]] - truth[:, JOINT_INDEX[f"shoulder_{side}"]]
        length = np.maximum(np.linalg.norm(bone, axis=1), 1e-9)
        shares += [np.linalg.norm(bone[:, [0, 1]], axis=1) / length, np.linalg.norm(bone[:, [1, 2]], axis=1) / length]
    known = np.ones_like(answers.counted)
    return AnglePairs(
        body_angles_deg(truth, answers.counted, config), body_angles_deg(found, known, config), np.stack(shares, axis=1)
    )


@dataclass(frozen=True, slots=True)
class AngleFigure:
    """Of n truths: share answered; mean, median and 95th percentile of the absolute error, mean error [deg]."""

    n: int
    answered: float
    mean: float
    median: float
    p95: float
    bias: float


def angle_figure(true: Floats, found: Floats) -> AngleFigure:
    """Figures of found (N,) against true (N,) angles."""
    error = (found - true)[~np.isnan(found)]
    if len(error) == 0:
        return AngleFigure(len(true), 0.0, *(float("nan"),) * 4)
    size = np.abs(error)
    values = (size.mean(), np.median(size), np.quantile(size, 0.95), error.mean())
    return AngleFigure(len(true), len(error) / len(true), *(float(v) for v in values))


def right_bins(pairs: AnglePairs, mapping: MappingConfig, clear_deg: float, least_share: float) -> tuple[float, int]:
    """Share of theta1 and theta2 in their true 15-degree step, and how many; no answer is wrong.

    Only angles at least clear_deg off every edge between steps, whose upper arm's projection is at least least_share
    of its length.
    """
    hit = total = 0
    for column, name in enumerate(("theta1_right", "theta2_right", "theta1_left", "theta2_left")):
        k = ANGLES.index(name)
        true, found = pairs.true[:, k], pairs.found[:, k]
        half = mapping.step_deg / 2
        nearest_edge = np.abs(true % mapping.step_deg - half)  # edges lie at 7.5, 22.5, ... 82.5
        last_edge = mapping.shoulder_max_deg - half
        clear = (nearest_edge >= clear_deg) | (true > last_edge + clear_deg)
        use = ~np.isnan(true) & clear & (pairs.share[:, column] >= least_share)
        for t, f in zip(true[use], found[use], strict=True):
            total += 1
            hit += not np.isnan(f) and nearest_step(f, mapping) == nearest_step(t, mapping)
    return (hit / total if total else float("nan")), total


def right_task(pairs: AnglePairs, config: TaskConfig) -> tuple[float, int]:
    """Share of frames whose T1 lies on the true side of the threshold between spraying and picking, and how many."""
    true, found = pairs.of("T1")
    hit = ~np.isnan(found) & ((found > config.T1_deg) == (true > config.T1_deg))
    return (float(hit.mean()) if len(hit) else float("nan")), len(hit)


def by_angle(true: Floats, found: Floats, width_deg: float = 10.0) -> list[tuple[float, float, float, int]]:
    """(middle of the bin, mean error, mean absolute error, n) for bins of the true angle, as the source's figure 12."""
    out = []
    known = ~np.isnan(found)
    for low in np.arange(0.0, 180.0, width_deg):
        inside = known & (true >= low) & (true < low + width_deg)
        if inside.sum() >= 5:
            error = found[inside] - true[inside]
            out.append((low + width_deg / 2, float(error.mean()), float(np.abs(error).mean()), int(inside.sum())))
    return out
