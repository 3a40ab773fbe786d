"""Evaluation as Markdown tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from teleop.config.intent import AngleConfig
from teleop.joints import JOINT_NAMES
from teleop.training.evaluation import STAGES, Answers
from teleop.training.metrics import ANGLES, JointFigures, body_angles_deg, joint_figures


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [head, ["---", *["---:"] * (len(head) - 1)], *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


def figures_of(answers: Answers) -> JointFigures:
    """Joint figures of all the frames."""
    return joint_figures(answers.joints_m, answers.confidence, answers.truth_m, answers.counted)


def near_share(figures: JointFigures, joints: Sequence[int]) -> float:
    """Share of all counted truths of these joints that are within 10 cm."""
    n = figures.count[list(joints)]
    return float(np.nansum(figures.near[list(joints)] * n) / max(int(n.sum()), 1))


def joint_table(answers: Answers) -> str:
    """One row a joint, the last for all."""
    f = figures_of(answers)

    def row(name: str, count: int, *values: float) -> list[str]:
        shown = [f"{100 * values[0]:.1f}", f"{100 * values[1]:.1f}", *(f"{1000 * v:.0f}" for v in values[2:4])]
        return [name, str(count), *shown, f"{values[4]:.3f}"]

    rows = [
        row(name, int(f.count[j]), f.near[j], f.answered[j], f.mean_m[j], f.median_m[j], f.precision[j])
        for j, name in enumerate(JOINT_NAMES)
        if f.count[j] > 0
    ]
    error = np.linalg.norm(answers.joints_m - answers.truth_m, axis=2)[answers.counted]
    known = ~np.isnan(error)
    everything = (
        near_share(f, range(len(JOINT_NAMES))),
        float(known.mean()),
        float(error[known].mean()),
        float(np.median(error[known])),
        float(np.nanmean(f.precision)),
    )
    rows.append(row("**all** (AP: mean)", len(error), *everything))
    return table(("joint", "n", "within 10 cm %", "answered %", "mean mm", "median mm", "AP at 10 cm"), rows)


def angle_table(answers: Answers, config: AngleConfig) -> str:
    """Errors of the angles where the truth's joints are visible."""
    truth = body_angles_deg(answers.truth_m, answers.counted, config)
    found = body_angles_deg(answers.joints_m, np.ones_like(answers.counted), config)
    rows = []
    for k, name in enumerate(ANGLES):
        both = ~np.isnan(truth[:, k])
        error = np.abs(found[both, k] - truth[both, k])
        error = error[~np.isnan(error)]
        if len(error):
            numbers = (error.mean(), float(np.median(error)), float(np.quantile(error, 0.95)))
            rows.append([name, str(len(error)), f"{100 * len(error) / both.sum():.1f}", *(f"{v:.1f}" for v in numbers)])
    return table(("angle", "n", "answered %", "mean deg", "median deg", "p95 deg"), rows)


def time_table(seconds: npt.NDArray[np.float64], area_px: int) -> str:
    """Milliseconds per stage. seconds: (N, stages)."""
    rows = [
        [stage, *(f"{1000 * v:.2f}" for v in np.quantile(seconds[:, k], (0.5, 0.95, 0.99)))]
        for k, stage in enumerate(STAGES)
    ]
    return f"Operator of about {area_px} pixels.\n\n" + table(("stage", "median ms", "p95", "p99"), rows)
