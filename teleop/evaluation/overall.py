"""Unseen people overall: parts, joints, precision, angles; the sampler's extreme poses and operators at work."""

from __future__ import annotations

from functools import partial

import numpy as np

from teleop.config.intent import AngleConfig
from teleop.evaluation.angle_figures import ANGLES, AnglePairs, angle_figure, angle_pairs, by_angle
from teleop.evaluation.answers import Answers
from teleop.evaluation.metrics import JointFigures, errors_m, figures_of, near_share, part_accuracy
from teleop.evaluation.plots import angle_plot, confusion_plot, joint_plot
from teleop.evaluation.sampled import PER_BATCH, Sampled
from teleop.evaluation.section import Bench, Section, percent, table
from teleop.evaluation.stills import BATCH, Stills
from teleop.joints import JOINT_NAMES


def joint_table(answers: Answers) -> str:
    """One row a joint, the last for all."""
    f = figures_of(answers)

    def row(name: str, count: int, near: float, answered: float, *mm_and_ap: float) -> list[str]:
        *metres, precision = mm_and_ap
        return [
            name,
            str(count),
            percent(near),
            percent(answered),
            *(f"{1000 * v:.0f}" for v in metres),
            f"{precision:.3f}",
        ]

    rows = [
        row(name, int(f.count[j]), f.near[j], f.answered[j], f.median_m[j], f.mean_m[j], f.p95_m[j], f.precision[j])
        for j, name in enumerate(JOINT_NAMES)
        if f.count[j] > 0
    ]
    error = errors_m(answers)
    known = error[~np.isnan(error)]
    if len(known):
        sizes = (float(np.median(known)), float(known.mean()), float(np.quantile(known, 0.95)))
        precision = float(np.nanmean(f.precision))
        rows.append(row("**all** (AP: mean)", len(error), near_share(f), len(known) / len(error), *sizes, precision))
    head = ("joint", "n", "within 10 cm %", "answered %", "median mm", "mean mm", "p95 mm", "AP at 10 cm")
    return table(head, rows)


def angle_table(pairs: AnglePairs) -> str:
    """Errors of the angles where the truth's joints are seen; both sides together."""
    rows = []
    for name in ("theta1", "theta2", "theta3", "T1", "T2"):
        f = angle_figure(*pairs.of(name))
        if f.n:
            rows.append([name, str(f.n), percent(f.answered), *(f"{v:.2f}" for v in (f.mean, f.median, f.p95, f.bias))])
    return table(("angle", "n", "answered %", "mean deg", "median deg", "p95 deg", "bias deg"), rows)


def joint_numbers(prefix: str, answers: Answers, figures: JointFigures) -> dict[str, float]:
    """The figures of the must-show table."""
    error = errors_m(answers)
    known = error[~np.isnan(error)]
    accuracy, balanced = part_accuracy(answers.confusion)
    return {
        f"{prefix}.within_10cm": near_share(figures),
        f"{prefix}.median_mm": 1000 * float(np.median(known)) if len(known) else float("nan"),
        f"{prefix}.map_10cm": float(np.nanmean(figures.precision)),
        f"{prefix}.part_accuracy": accuracy,
        f"{prefix}.part_accuracy_balanced": balanced,
        f"{prefix}.nobody_found": 1.0 - float(answers.found.mean()),
    }


def angle_numbers(prefix: str, pairs: AnglePairs) -> dict[str, float]:
    """Mean and 95th percentile of every angle's error."""
    out: dict[str, float] = {}
    for name in ("theta1", "theta2", "theta3", "T1", "T2"):
        f = angle_figure(*pairs.of(name))
        out |= {f"{prefix}.{name}_mean_deg": f.mean, f"{prefix}.{name}_p95_deg": f.p95}
    return out


def people_section(bench: Bench) -> list[Section]:
    """The sampler's test split cut out and in rooms, and operators with free arms in rooms; single frames."""
    sets = (
        ("sampled_cut_out", "sampler's test split, cut out, extreme poses", Sampled(), PER_BATCH),
        ("sampled_room", "sampler's test split in rooms, extreme poses", Sampled(room=True), PER_BATCH),
        ("free", "operators with free arms, in rooms", Stills("free"), BATCH),
    )
    return [_one(bench, *what) for what in sets]


def _one(bench: Bench, key: str, title: str, frames: Sampled | Stills, per_batch: int) -> Section:
    answers = bench.run(title, frames, -(-bench.frames // per_batch))
    figures = figures_of(answers)
    pairs = angle_pairs(answers, AngleConfig())
    numbers = joint_numbers(key, answers, figures) | angle_numbers(key, pairs)
    text = "\n\n".join(
        (
            f"{len(answers)} single frames, 640x480, people never seen in training. Parts: "
            f"{percent(numbers[f'{key}.part_accuracy'])} % of the person's pixels right, "
            f"{percent(numbers[f'{key}.part_accuracy_balanced'])} % averaged over the parts. Nobody found in "
            f"{percent(numbers[f'{key}.nobody_found'])} %.",
            joint_table(answers),
            "Angles in levelled axes where the tracker saw the floor."
            if key != "sampled_cut_out"
            else "Angles in the camera's own axes.",
            angle_table(pairs),
        )
    )
    curves = {name: by_angle(*pairs.of(name)) for name in dict.fromkeys(n.rsplit("_", 1)[0] for n in ANGLES)}
    plots = {
        f"{key}_joints": partial(joint_plot, figures, title),
        f"{key}_confusion": partial(confusion_plot, answers.confusion, title),
        f"{key}_angles": partial(angle_plot, curves, title),
    }
    return Section(title[0].upper() + title[1:], text, numbers, plots)
