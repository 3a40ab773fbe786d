"""The hand study: our rule against the source's on the same frames; Markdown, CSV and a picture."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from teleop.body.tracker import BodyTracker
from teleop.config.intent import HandConfig
from teleop.hands.learning.cases import JOINT_NOISE_M, JOINTS, RULES, Case, Progress, rendered_cases
from teleop.hands.learning.sessions import SessionFigures
from teleop.hands.learning.tally import Share
from teleop.intent_types import Hand

UNREADABLE: Final = (
    "A hand is *unreadable*, and answered `unknown`, when geometry that is known at run time says that its state "
    "cannot be seen: the forearm points along the camera's ray (cosine above `max_ray_cos`), or too few depth pixels "
    "lie at the hand (`min_pixels`: hidden, off the image, beyond the sensor). A hand before face or body and a palm "
    "seen edge-on are read: the relief of the depth image tells most of them, and the network's calibrated "
    "probability leaves the rest undecided (`decide_margin`). Truth decides nothing. Hands between open and fist are "
    "not drawn: those are transitions. Scored: every hand of which something is in the image, 1.4 to 3.5 m away, "
    "unreadable ones included."
)


def share(cases: Iterable[Case], joints: str, rule: str) -> Share:
    """The figures of one rule with one kind of joints."""
    answers = [(case.answers[joints, rule], case.truth) for case in cases]
    decided = [(answer, truth) for answer, truth in answers if answer is not Hand.UNKNOWN]
    return Share(len(answers), len(decided), sum(answer is truth for answer, truth in decided))


Group = tuple[str, Callable[[Case], bool]]
GROUPS: Final[tuple[tuple[str, tuple[Group, ...]], ...]] = (
    (
        "skin",
        (
            ("light", lambda c: c.tone > 165),
            ("medium", lambda c: 105 < c.tone <= 165),
            ("dark", lambda c: c.tone <= 105),
        ),
    ),
    (
        "light",
        (
            ("0.55-0.75", lambda c: c.light < 0.75),
            ("0.75-0.95", lambda c: 0.75 <= c.light < 0.95),
            ("0.95-1.15", lambda c: c.light >= 0.95),
        ),
    ),
    (
        "distance",
        (
            ("1.4-2.0 m", lambda c: c.z_m < 2.0),
            ("2.0-2.8 m", lambda c: 2.0 <= c.z_m < 2.8),
            ("2.8-3.5 m", lambda c: c.z_m >= 2.8),
        ),
    ),
    (
        "palm",
        (
            ("to the sensor", lambda c: c.palm_cos > 0.5),
            ("edge-on", lambda c: abs(c.palm_cos) <= 0.5),
            ("back to the sensor", lambda c: c.palm_cos < -0.5),
        ),
    ),
    (
        "forearm",
        (
            ("across the ray", lambda c: c.ray_cos < 0.5),
            ("between", lambda c: 0.5 <= c.ray_cos < 0.85),
            ("along the ray", lambda c: c.ray_cos >= 0.85),
        ),
    ),
    ("walls", (("in skin colour", lambda c: c.skin_wall), ("others", lambda c: not c.skin_wall))),
    ("place", (("before face or body", lambda c: c.before_body), ("beside it", lambda c: not c.before_body))),
)


def _row(cells: Iterable[object]) -> str:
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def _table(head: list[str], rows: Iterable[Iterable[object]]) -> str:
    return "\n".join([_row(head), _row("---" for _ in head), *(_row(row) for row in rows)])


def _percent(value: float) -> str:
    return f"{value:.1f} %"


def rules_table(cases: list[Case]) -> str:
    """Every rule with every kind of joints that was tried."""
    rows = []
    for joints in JOINTS:
        if all(share(cases, joints, rule).decided == 0 for rule in RULES):
            continue
        for rule in RULES:
            s = share(cases, joints, rule)
            rows.append((joints, rule, s.hands, _percent(s.decided_percent), _percent(s.right_percent)))
    return _table(["joints", "rule", "hands", "decided", "right of decided"], rows)


def groups_table(cases: list[Case], joints: str) -> str:
    """Ours and the source's calibrated rule by skin, light, distance, orientation, wall and place."""
    rows = []
    for name, groups in GROUPS:
        for label, belongs in groups:
            mine = [case for case in cases if belongs(case)]
            if not mine:
                continue
            ours, source = share(mine, joints, RULES[0]), share(mine, joints, RULES[2])
            depth = share(mine, joints, RULES[1])
            figures = (f"{_percent(s.right_percent)} of {_percent(s.decided_percent)}" for s in (ours, depth, source))
            rows.append((f"{name}: {label}", len(mine), *figures))
    return _table(["right of decided", "hands", *RULES[:3]], rows)


def confusion_table(cases: list[Case], joints: str) -> str:
    """Truth in rows, answers in columns, ours."""
    rows = []
    for truth in (Hand.OPEN, Hand.FIST):
        answers = [case.answers[joints, RULES[0]] for case in cases if case.truth is truth]
        rows.append((truth, *(answers.count(hand) for hand in (Hand.OPEN, Hand.FIST, Hand.UNKNOWN))))
    return _table(["truth", "open", "fist", "unknown"], rows)


def illegible_table(cases: list[Case]) -> str:
    """How many hands geometry forbids to read, by reason."""
    reasons = sorted({case.illegible for case in cases if case.illegible is not None})
    counted = ((reason, sum(case.illegible == reason for case in cases)) for reason in reasons)
    return _table(["unreadable", "hands", "share"], ((r, n, _percent(100.0 * n / len(cases))) for r, n in counted))


@dataclass(frozen=True, slots=True)
class HandStudy:
    """What a study measured. webcam: figures on real photographs, recordings left out; None when not run."""

    cases: list[Case]
    webcam: Share | None
    session: SessionFigures | None


def report(study: HandStudy, config: HandConfig) -> str:
    """The study as Markdown."""
    cases = study.cases
    head = share(cases, JOINTS[0], RULES[0])
    text = [
        "# Hands: ours against the source's rule",
        f"{head.hands} hands of rendered people never seen in training, single frames. Ours: "
        f"**{_percent(head.right_percent)} right of the {_percent(head.decided_percent)} decided** "
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
    if study.session is not None:
        text += ["## After the debounce", study.session.table()]
    if study.webcam is not None:
        w = study.webcam
        text += [
            "## Real hands",
            f"Webcam photographs, hand cropped by its box, every recording judged by a network that never saw it: "
            f"**{_percent(100.0 * w.right / w.hands)} right of all {w.hands}** (no reject).",
        ]
    return "\n\n".join(text) + "\n"


def write_csv(path: Path, cases: list[Case]) -> None:
    """One row per hand: truth, description, every rule's answer."""
    fields = ("tone", "light", "z_m", "palm_cos", "ray_cos", "skin_wall", "before_body", "illegible", "logit")
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
    study = HandStudy(rendered_cases(people, tracker, config, progress), webcam, session)
    output.mkdir(parents=True, exist_ok=True)
    text = report(study, config)
    (output / "hands.md").write_text(text, encoding="utf-8")
    write_csv(output / "hands.csv", study.cases)
    draw(output / "hands.png", study.cases)
    return text
