"""The hand study's counts: shares of rules and groups of hands, as Markdown tables."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Final

from teleop.hands.learning.cases import JOINTS, RULES, Case
from teleop.hands.learning.tally import Share
from teleop.intent_types import Hand


def share(cases: Iterable[Case], joints: str, rule: str) -> Share:
    """The figures of one rule with one kind of joints."""
    answers = [(case.answers[joints, rule], case.truth) for case in cases]
    decided = [(answer, truth) for answer, truth in answers if answer is not Hand.UNKNOWN]
    return Share(len(answers), len(decided), sum(answer is truth for answer, truth in decided))


Group = tuple[str, Callable[[Case], bool]]
CLOSED: Final = ((0.14, 0.3), (0.3, 0.5), (0.5, 0.7), (0.7, 0.86))
"""How far a hand is closed, 0 flat open, 1 fist: a relaxed one about 0.3."""
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
    (
        "other hand",
        (("nearer than 0.25 m", lambda c: c.apart_m < 0.25), ("0.25 m or more away", lambda c: c.apart_m >= 0.25)),
    ),
)


def _row(cells: Iterable[object]) -> str:
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def _table(head: list[str], rows: Iterable[Iterable[object]]) -> str:
    return "\n".join([_row(head), _row("---" for _ in head), *(_row(row) for row in rows)])


def percent(value: float) -> str:
    return f"{value:.1f} %"


def rules_table(cases: list[Case]) -> str:
    """Every rule with every kind of joints that was tried."""
    rows = []
    for joints in JOINTS:
        if all(share(cases, joints, rule).decided == 0 for rule in RULES):
            continue
        for rule in RULES:
            s = share(cases, joints, rule)
            rows.append((joints, rule, s.hands, percent(s.decided_percent), percent(s.right_percent)))
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
            figures = (f"{percent(s.right_percent)} of {percent(s.decided_percent)}" for s in (ours, depth, source))
            rows.append((f"{name}: {label}", len(mine), *figures))
    return _table(["right of decided", "hands", *RULES[:3]], rows)


def confusion_table(cases: list[Case], joints: str) -> str:
    """Truth in rows, answers in columns, ours."""
    rows = []
    for truth in (Hand.OPEN, Hand.FIST):
        answers = [case.answers[joints, RULES[0]] for case in cases if case.truth is truth]
        rows.append((truth, *(answers.count(hand) for hand in (Hand.OPEN, Hand.FIST, Hand.UNKNOWN))))
    return _table(["truth", "open", "fist", "unknown"], rows)


def between_table(cases: list[Case], joints: str) -> str:
    """What is answered to hands that are neither flat open nor a fist, by how far they are closed."""
    rows = []
    for low, high in CLOSED:
        answers = [case.answers[joints, RULES[0]] for case in cases if low <= case.curl < high]
        shares = (100.0 * answers.count(hand) / max(1, len(answers)) for hand in (Hand.OPEN, Hand.FIST, Hand.UNKNOWN))
        rows.append((f"{100 * low:.0f}-{100 * high:.0f} %", len(answers), *map(percent, shares)))
    return _table(["closed", "hands", "open", "fist", "unknown"], rows)


def illegible_table(cases: list[Case]) -> str:
    """How many hands geometry forbids to read, by reason."""
    reasons = sorted({case.illegible for case in cases if case.illegible is not None})
    counted = ((reason, sum(case.illegible == reason for case in cases)) for reason in reasons)
    return _table(["unreadable", "hands", "share"], ((r, n, percent(100.0 * n / len(cases))) for r, n in counted))
