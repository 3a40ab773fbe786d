"""One thing changed at a time: sensor height and tilt, distance, resolution, mirror, lost pixels, others, furniture."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np

from teleop.evaluation.angle_figures import angle_figure, angle_pairs
from teleop.evaluation.metrics import errors_m, figures_of, near_share
from teleop.evaluation.plots import bars
from teleop.evaluation.section import Bench, Section, percent, table
from teleop.evaluation.stills import BATCH, Stills

BASE: Final = Stills("free", distance_m=(2.3, 2.3), height_m=(1.0, 1.0), tilt_deg=(0.0, 0.0))
SETTINGS: Final[dict[str, Stills]] = {
    "base: 640x480, 1.0 m high, level, person at 2.3 m": BASE,
    "sensor 0.6 m high": replace(BASE, height_m=(0.6, 0.6)),
    "sensor 1.4 m high": replace(BASE, height_m=(1.4, 1.4)),
    "tilt -15 deg": replace(BASE, tilt_deg=(-15.0, -15.0)),
    "tilt +15 deg": replace(BASE, tilt_deg=(15.0, 15.0)),
    "person at 1.5 m": replace(BASE, distance_m=(1.5, 1.5)),
    "person at 3.4 m": replace(BASE, distance_m=(3.4, 3.4)),
    "320x240": replace(BASE, width=320, height=240),
    "mirrored image": replace(BASE, mirrored=True),
    "10 % of the pixels lost": replace(BASE, dropout=0.1),
    "a second person behind": replace(BASE, behind=True),
    "furniture within arm's reach": replace(BASE, furniture=True),
}


def robustness_section(bench: Bench) -> list[Section]:
    """The same people and poses in every setting, single frames in rooms."""
    batches = max(2, round(0.3 * bench.frames / BATCH))
    rows: list[list[str]] = []
    figures: dict[str, float] = {}
    near_all: list[float] = []
    for name, setting in SETTINGS.items():
        answers = bench.run(name, setting, batches)
        near, error = near_share(figures_of(answers)), errors_m(answers)
        pairs = angle_pairs(answers, bench.config.intent.angles)
        elbow, side, front = (angle_figure(*pairs.of(a)) for a in ("theta3", "theta1", "theta2"))
        known = error[~np.isnan(error)]
        median_mm = 1000 * float(np.median(known)) if len(known) else float("nan")
        rows.append(
            [name, str(len(error)), percent(near), f"{median_mm:.0f}",
             *(f"{v:.1f}" for v in (elbow.mean, side.mean, front.mean)), percent(1 - float(answers.found.mean()))]
        )  # fmt: skip
        figures[f"robustness.{name}.within_10cm"] = near
        near_all.append(100 * near)
    head = ("setting", "joints", "within 10 cm %", "median mm", "elbow mean deg", "theta1", "theta2", "nobody found %")
    text = (
        "Operators with free arms in random rooms; one thing changed at a time. 10 frames/s: see free arm motion.\n\n"
    )
    plot = partial(bars, list(SETTINGS), near_all, "visible joints within 10 cm [%]", 95.0)
    return [Section("Robustness", text + table(head, rows), figures, {"robustness": plot})]
