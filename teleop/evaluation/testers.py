"""The source's experiment (section 4.2, figure 12): ten testers, captured against true angles."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Final, Literal

import numpy as np

from teleop.config.intent import AngleConfig
from teleop.evaluation.angle_figures import ANGLES, angle_pairs
from teleop.evaluation.answers import Answers
from teleop.evaluation.plots import testers_plot
from teleop.evaluation.poses import PROTOCOL
from teleop.evaluation.section import Bench, Section, table
from teleop.evaluation.stills import TESTERS, Testers

Movement = Literal["forward", "sideways", "elbow_forward", "elbow_across"]
MOVEMENTS: Final[tuple[tuple[Movement, str, str, float], ...]] = (
    ("forward", "shoulder forward", "theta2", 5.80),
    ("sideways", "shoulder sideways", "theta1", 5.80),
    ("elbow_forward", "elbow, forearm towards the sensor", "theta3", 1.90),
    ("elbow_across", "elbow, forearm across the view", "theta3", 1.90),
)
"""Movement, words, the angle, the source's largest error of the mean [deg]."""


@dataclass(frozen=True, slots=True)
class Curve:
    """Per level [deg]: mean and standard deviation over testers of captured minus true; share answered."""

    levels: list[float]
    mean: list[float]
    spread: list[float]
    answered: float

    @property
    def largest(self) -> float:
        """Largest absolute error of the mean [deg]; not a number when a level has no answer at all."""
        return float(np.max(np.abs(self.mean)))


def tester_curve(answers: Answers, angle: str) -> Curve:
    """From the answers of one movement."""
    pairs = angle_pairs(answers, AngleConfig())
    columns = [ANGLES.index(f"{angle}_{side}") for side in ("right", "left")]
    error = pairs.found[:, columns] - pairs.true[:, columns]
    levels = sorted(set(answers.level.tolist()))
    mean, spread = [], []
    for level in levels:
        rows = answers.level == level
        people = [error[rows & (answers.group == g)] for g in sorted(set(answers.group.tolist()))]
        each = np.array([np.nanmean(p) for p in people if not np.isnan(p).all()])
        mean.append(float(each.mean()) if len(each) else float("nan"))
        spread.append(float(each.std()) if len(each) else float("nan"))
    true = ~np.isnan(pairs.true[:, columns])
    return Curve(levels, mean, spread, float((~np.isnan(error))[true].mean()))


def testers_section(bench: Bench) -> list[Section]:
    """All movements of all testers, single frames, in rooms, levelled by the floor the tracker found itself."""
    curves = {}
    for movement, words, angle, _ in MOVEMENTS:
        answers = bench.run(f"ten testers, {words}", Testers(movement), TESTERS)
        curves[movement] = tester_curve(answers, angle)
    summary = table(
        ("movement", "largest error of the mean deg", "source deg", "answered %"),
        [
            [words, f"{curves[m].largest:.2f}", f"{source:.2f}", f"{100 * curves[m].answered:.1f}"]
            for m, words, _, source in MOVEMENTS
        ],
    )
    shoulder = [
        [f"{level:.0f}", *(f"{curves[m].mean[n]:+.2f} ({curves[m].spread[n]:.2f})" for m in ("forward", "sideways"))]
        for n, level in enumerate(PROTOCOL["forward"])
    ]
    elbow = [
        [
            f"{lv:.0f}",
            *(f"{curves[m].mean[n]:+.2f} ({curves[m].spread[n]:.2f})" for m in ("elbow_forward", "elbow_across")),
        ]
        for n, lv in enumerate(PROTOCOL["elbow_forward"])
    ]
    text = "\n\n".join(
        (
            "Ten rendered people of 165-190 cm and 45-90 kg, both arms at each angle of the source's experiment, "
            "single frames in rooms; captured minus true, mean over the testers. The true angle is that of the "
            "person's own joints, as the source's was measured on the arm.",
            summary,
            "Captured minus true [deg], mean (standard deviation) over the testers:",
            table(("shoulder asked deg", "forward", "sideways"), shoulder),
            table(("elbow asked deg", "forearm towards the sensor", "forearm across the view"), elbow),
        )
    )
    figures = {f"testers.{m}_largest_deg": c.largest for m, c in curves.items()}
    panels = {w: (curves[m].levels, curves[m].mean, curves[m].spread, s) for m, w, _, s in MOVEMENTS}
    return [Section("Ten testers, the source's protocol", text, figures, {"testers": partial(testers_plot, panels)})]
