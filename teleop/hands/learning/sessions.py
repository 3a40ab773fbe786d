"""Hands over a recorded session with known truth: single frames and after the debounce, and how late changes come."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from teleop.errors import DataError
from teleop.hands.reader import read_hands
from teleop.hands.skin_model import step_skin
from teleop.intent_types import SIDES, Hand
from teleop.pipeline import Pipeline
from teleop.sources import open_source

RECORDING: Final = Path(__file__).resolve().parents[3] / "recordings" / "greenhouse_demo.mcap"
EARLY_S, LATE_S = 0.8, 1.0
"""A change of ours belongs to a true one from when the fingers may begin to move until this long after they end."""
SETTLE_S: Final = 0.4
"""Settled states are not scored for this long after a true change: their delay is counted instead."""


@dataclass(frozen=True, slots=True)
class SessionFigures:
    """hands: readings scored. steady: those not within SETTLE_S after a true change, where settled states are scored.
    single, settled: (decided, right). delays_s: from each true change to ours.
    changes, missed: true changes and those not followed; wrong_changes: ours that were not true."""

    hands: int
    steady: int
    single: tuple[int, int]
    settled: tuple[int, int]
    delays_s: tuple[float, ...]
    changes: int
    wrong_changes: int

    def table(self) -> str:
        """The figures as Markdown."""
        rows = ["| bundled recording, tracker's joints | decided | right of decided |", "|---|---|---|"]
        for name, hands, (decided, right) in (
            ("single frames", self.hands, self.single),
            ("after the debounce", self.steady, self.settled),
        ):
            rows.append(f"| {name} | {100 * decided / hands:.1f} % | {100 * right / max(1, decided):.1f} % |")
        late = f"{1e3 * np.percentile(self.delays_s, 95):.0f} ms" if self.delays_s else "none"
        rows.append(
            f"\n{self.changes} true changes, {len(self.delays_s)} followed, 95 % of them within {late} "
            f"(full transition of the fingers to ours); {self.wrong_changes} changes of ours were not true."
        )
        return "\n".join(rows)


@dataclass(frozen=True, slots=True)
class _Moment:
    t_s: float
    truth: Hand
    single: Hand
    settled: Hand


def _moments(pipeline: Pipeline, recording: Path) -> dict[str, list[_Moment]]:
    truth_file = recording.with_suffix(".truth.jsonl")
    try:
        truths = [json.loads(line) for line in truth_file.read_text().splitlines()]
    except OSError as error:
        raise DataError(f"{truth_file}: {error.strerror}; the study needs a recording with its truth") from error
    out: dict[str, list[_Moment]] = {side: [] for side in SIDES}
    state = pipeline.initial_state(assume_engaged=True)
    skin = None
    config = pipeline.intent.hands
    with closing(open_source(str(recording))) as source:
        for frame, truth in zip(source.frames(), truths, strict=False):
            answer, state = pipeline.step(frame, state)
            body = answer.track.skeleton
            skin = step_skin(None if answer.track.reset else skin, frame, body, config)
            single = read_hands(frame, body, config, skin)
            if not truth["seen"]:
                continue
            for side in SIDES:
                now = _Moment(
                    frame.t_s, Hand(truth["hands"][side]), getattr(single, side), getattr(answer.intent.hands, side)
                )
                out[side].append(now)
    return out


def _changes(states: list[tuple[float, Hand]]) -> Iterator[tuple[float, Hand]]:
    """When a hand became open or fist that was the other one before."""
    last: Hand | None = None
    for t_s, hand in states:
        if hand is Hand.UNKNOWN:
            continue
        if last is not None and hand is not last:
            yield t_s, hand
        last = hand


def session_figures(pipeline: Pipeline, recording: Path = RECORDING) -> SessionFigures:
    """Run the pipeline over a recording that has its truth beside it. Raises DataError when that is missing."""
    hands, steady, single, settled, delays, changes, wrong = 0, 0, [0, 0], [0, 0], [], 0, 0
    for moments in _moments(pipeline, recording).values():
        true_changes = list(_changes([(m.t_s, m.truth) for m in moments]))
        ours = list(_changes([(m.t_s, m.settled) for m in moments]))
        changes += len(true_changes)
        free = list(ours)
        for t_s, hand in true_changes:
            hit = next((c for c in free if c[1] is hand and -EARLY_S <= c[0] - t_s <= LATE_S), None)
            if hit is not None:
                free.remove(hit)
                delays.append(max(0.0, hit[0] - t_s))
        # while the fingers are half closed both answers are right
        truth_at = {m.t_s: m.truth for m in moments}
        wrong += sum(truth_at[t_s] not in (hand, Hand.UNKNOWN) for t_s, hand in free)
        for m in moments:
            if m.truth is Hand.UNKNOWN:
                continue
            hands += 1
            just_changed = any(0.0 <= m.t_s - t_s < SETTLE_S for t_s, _ in true_changes)
            single[0] += m.single is not Hand.UNKNOWN
            single[1] += m.single is m.truth
            if not just_changed:
                steady += 1
                settled[0] += m.settled is not Hand.UNKNOWN
                settled[1] += m.settled is m.truth
    return SessionFigures(
        hands, steady, (single[0], single[1]), (settled[0], settled[1]), tuple(delays), changes, wrong
    )
