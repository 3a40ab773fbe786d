"""The hand study: our rule against the source's on the same frames; Markdown, CSV and a picture."""

from __future__ import annotations

import csv
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np

from teleop.body.tracker import BodyTracker
from teleop.config.intent import HandConfig
from teleop.hands.learning.cases import BETWEEN, GLOVED, JOINT_NOISE_M, JOINTS, RULES, Case, Progress, rendered_cases
from teleop.hands.learning.sessions import SessionFigures
from teleop.hands.learning.tables import (
    GROUPS,
    between_table,
    confusion_table,
    groups_table,
    illegible_table,
    percent,
    rules_table,
    share,
)
from teleop.hands.learning.tally import Share
from teleop.intent_types import Hand

UNREADABLE: Final = (
    "A hand is *unreadable*, and answered `unknown`, when geometry that is known at run time says that its state "
    "cannot be seen: the forearm points along the camera's ray (cosine above `max_ray_cos`), or too few depth pixels "
    "lie at the hand (`min_pixels`: hidden, off the image, beyond the sensor). A hand before face or body and a palm "
    "seen edge-on are read: the relief of the depth image tells most of them, and the network's calibrated "
    "probability leaves the rest undecided (`decide_margin`). Truth decides nothing. Scored: every hand "
    "of which something is in the image, 1.4 to 3.5 m away, unreadable ones included."
)


@dataclass(frozen=True, slots=True)
class HandStudy:
    """What a study measured. gloved, between: other hands than the bare open ones and fists of ``cases``.
    webcam: figures on real photographs, recordings left out; None when not run."""

    cases: list[Case]
    webcam: Share | None
    session: SessionFigures | None
    gloved: list[Case] = field(default_factory=list)
    between: list[Case] = field(default_factory=list)


def report(study: HandStudy, config: HandConfig) -> str:
    """The study as Markdown."""
    cases = study.cases
    head = share(cases, JOINTS[0], RULES[0])
    text = [
        "# Hands: ours against the source's rule",
        f"{head.hands} hands of rendered people never seen in training, single frames. Ours: "
        f"**{percent(head.right_percent)} right of the {percent(head.decided_percent)} decided** "
        f"(margin {config.decide_margin:g} in log odds).",
        rules_table(cases),
        f"True joints carry white noise of {1e3 * JOINT_NOISE_M:.0f} mm in each axis; the tracker's are its "
        "single-frame answer, unfiltered. The source's rule answers whenever its crop lies in the image.",
        "## What is unreadable",
        UNREADABLE,
        illegible_table(cases),
        "## By skin, light, distance, orientation, wall",
        groups_table(cases, JOINTS[0]),
        "## Confusion",
        confusion_table(cases, JOINTS[0]),
    ]
    if study.gloved:
        g = share(study.gloved, JOINTS[0], RULES[0])
        text += [
            "## Gloves",
            f"The same people in gloves of any colour, 0.5 to 4 mm thick, {g.hands} hands: "
            f"{percent(g.right_percent)} right of the {percent(g.decided_percent)} decided.",
        ]
    if study.between:
        text += [
            "## Hands half closed, relaxed hands",
            "Neither answer is right; what matters is that the settled state does not flicker (debounce), and that a "
            "relaxed hand starts nothing: the spray needs a fist that opens on a raised arm.",
            between_table(study.between, JOINTS[0]),
        ]
    if study.session is not None:
        text += ["## After the debounce", study.session.table()]
    if study.webcam is not None:
        w = study.webcam
        text += [
            "## Real hands",
            f"Webcam photographs, hand cropped by its box, every recording judged by a network that never saw it: "
            f"**{percent(100.0 * w.right / w.hands)} right of all {w.hands}** (no reject).",
        ]
    return "\n\n".join(text) + "\n"


def write_csv(path: Path, cases: list[Case]) -> None:
    """One row per hand: truth, description, every rule's answer."""
    fields = (
        "tone",
        "light",
        "z_m",
        "palm_cos",
        "ray_cos",
        "skin_wall",
        "before_body",
        "curl",
        "apart_m",
        "illegible",
        "logit",
    )
    keys = [(joints, rule) for joints in JOINTS for rule in RULES]
    with path.open("w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        out.writerow(["truth", *fields, *(f"{rule} ({joints})" for joints, rule in keys)])
        for case in cases:
            described = [getattr(case, name) for name in fields]
            described = [round(v, 4) if isinstance(v, float) else v for v in described]
            out.writerow([case.truth, *described, *(case.answers[key] for key in keys)])


def draw(path: Path, cases: list[Case]) -> None:
    """Right of decided against the share decided, the calibration, and ours beside the source's by group."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(16, 4.6), width_ratios=(1, 1, 2.2), layout="constrained")
    read = [(case.logit, case.truth is Hand.OPEN) for case in cases if case.logit is not None]
    logit, is_open = np.array([z for z, _ in read]), np.array([o for _, o in read])
    right = (logit > 0) == is_open
    order = np.argsort(-np.abs(logit))
    decided = 100.0 * np.arange(1, len(order) + 1) / len(cases)
    axes[0].plot(decided, 100.0 * np.cumsum(right[order]) / np.arange(1, len(order) + 1))
    axes[0].axhline(97, color="grey", lw=0.8, ls="--")
    axes[0].axvline(85, color="grey", lw=0.8, ls="--")
    axes[0].set(xlabel="decided of all hands [%]", ylabel="right of decided [%]", ylim=(88, 100.3), title="reject band")
    probability = 1.0 / (1.0 + np.exp(-logit))
    edges = np.linspace(0, 1, 11)
    which = np.clip(np.digitize(probability, edges) - 1, 0, 9)
    kept = [k for k in range(10) if (which == k).sum() >= 5]
    axes[1].plot([0, 1], [0, 1], color="grey", lw=0.8)
    axes[1].plot([probability[which == k].mean() for k in kept], [is_open[which == k].mean() for k in kept], "o-")
    axes[1].set(xlabel="probability told", ylabel="share of open hands", title="calibration")
    labels, ours, source = [], [], []
    for name, groups in GROUPS:
        for label, belongs in groups:
            mine = [case for case in cases if belongs(case)]
            if mine:
                labels.append(f"{name}: {label} ({len(mine)})")
                ours.append(share(mine, JOINTS[0], RULES[0]).right_percent)
                source.append(share(mine, JOINTS[0], RULES[2]).right_percent)
    y = np.arange(len(labels))
    axes[2].barh(y - 0.2, ours, 0.4, label="ours")
    axes[2].barh(y + 0.2, source, 0.4, label="source, ratio 0.33", color="silver")
    axes[2].set(yticks=y, yticklabels=labels, xlabel="right of decided [%]", xlim=(40, 100))
    axes[2].invert_yaxis()
    axes[2].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def run_study(
    output: Path,
    people: int,
    tracker: BodyTracker | None,
    webcam: Share | None,
    session: SessionFigures | None,
    config: HandConfig,
    progress: Progress,
) -> str:
    """Render, read, write ``hands.md``, ``hands.csv`` and ``hands.png`` into ``output``; the Markdown comes back."""
    study = HandStudy(
        rendered_cases(people, tracker, config, progress),
        webcam,
        session,
        rendered_cases(max(1, people // 4), None, config, progress, GLOVED),
        rendered_cases(max(1, people // 4), None, config, progress, BETWEEN),
    )
    output.mkdir(parents=True, exist_ok=True)
    text = report(study, config)
    (output / "hands.md").write_text(text, encoding="utf-8")
    write_csv(output / "hands.csv", study.cases)
    draw(output / "hands.png", study.cases)
    return text
