"""Rooms without a person: how often somebody is seen there."""

from __future__ import annotations

import numpy as np

from teleop.evaluation.nobody import KIND_NAMES, PER_BATCH, Nobody
from teleop.evaluation.section import Bench, Section, percent, table

LEAST_FRAMES = 210


def nobody_section(bench: Bench) -> list[Section]:
    """At least 210 rooms, the same number with each thing."""
    rounds = max(LEAST_FRAMES, 2 * bench.frames) // (PER_BATCH * len(KIND_NAMES))
    answers = bench.run("rooms without a person", Nobody(), rounds * len(KIND_NAMES))
    rows = []
    for kind, name in enumerate(KIND_NAMES):
        there = answers.found[answers.group == kind]
        rows.append([name, str(len(there)), str(int(there.sum())), percent(float(np.mean(there)))])
    rate = float(answers.found.mean())
    rows.append(["**all**", str(len(answers)), str(int(answers.found.sum())), percent(rate)])
    text = "Furnished rooms, with one more thing in the working area:\n\n"
    return [
        Section(
            "Rooms without a person",
            text + table(("thing", "frames", "persons seen", "%"), rows),
            {"nobody.rate": rate},
        )
    ]
