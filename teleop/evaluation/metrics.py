"""Joint figures: distance from the truth, found within 10 cm, average precision; part accuracy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.evaluation.answers import Answers

NEAR_M: Final = 0.10
"""A joint nearer to the truth than this is found (Shotton 2011)."""
Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class JointFigures:
    """Per joint (J,): how many truths counted, share answered, share within 10 cm of the truth (unanswered counts as
    wrong), mean, median and 95th percentile of the error [m] of the answered, average precision at 10 cm."""

    count: npt.NDArray[np.int64]
    answered: Floats
    near: Floats
    mean_m: Floats
    median_m: Floats
    p95_m: Floats
    precision: Floats


def joint_figures(found_m: Floats, confidence: Floats, truth_m: Floats, counted: Bools) -> JointFigures:
    """Figures of answers (F, J, 3), NaN unknown, with confidence (F, J), where ``counted`` (F, J)."""
    error = np.linalg.norm(found_m - truth_m, axis=2)
    joints = error.shape[1]
    out = [np.full(joints, np.nan) for _ in range(6)]
    for j in range(joints):
        e = error[counted[:, j], j]
        if len(e) == 0:
            continue
        known = ~np.isnan(e)
        out[0][j] = known.mean()
        out[1][j] = (e < NEAR_M).sum() / len(e)
        if known.any():
            out[2][j], out[3][j], out[4][j] = e[known].mean(), np.median(e[known]), np.quantile(e[known], 0.95)
        out[5][j] = average_precision(error[:, j] < NEAR_M, confidence[:, j], ~np.isnan(error[:, j]), counted[:, j])
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


def figures_of(answers: Answers) -> JointFigures:
    """Joint figures of all the frames."""
    return joint_figures(answers.joints_m, answers.confidence, answers.truth_m, answers.counted)


def near_share(figures: JointFigures, joints: Sequence[int] = range(20)) -> float:
    """Share of all counted truths of these joints that are within 10 cm."""
    n = figures.count[list(joints)]
    return float(np.nansum(figures.near[list(joints)] * n) / max(int(n.sum()), 1))


def errors_m(answers: Answers) -> Floats:
    """Errors (N,) in metres of all counted joints, NaN where unanswered."""
    return np.asarray(np.linalg.norm(answers.joints_m - answers.truth_m, axis=2)[answers.counted])


def part_accuracy(confusion: npt.NDArray[np.int64]) -> tuple[float, float]:
    """Share of the person's pixels given their true part; and the same averaged over parts (classes count alike)."""
    total = confusion.sum(axis=1)
    hit = np.diag(confusion)
    if not total.any():
        return float("nan"), float("nan")
    return float(hit.sum() / total.sum()), float((hit[total > 0] / total[total > 0]).mean())
