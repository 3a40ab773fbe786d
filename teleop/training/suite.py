"""The whole evaluation, from a model file to a Markdown report."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import islice
from pathlib import Path

import numpy as np

from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config.body import BodyConfig
from teleop.config.intent import AngleConfig
from teleop.errors import DataError
from teleop.training.build import Progress
from teleop.training.evaluation import (
    Answers,
    Truth,
    real,
    rendered,
    run_tracker,
    single_frame,
    time_stages,
)
from teleop.training.real import UPPER_BODY
from teleop.training.report import angle_table, figures_of, joint_table, near_share, table, time_table

TIMED_PX = (20_000, 30_000)
"""Operators of this many pixels are timed: the published figures are for about 25,000."""


def run_suite(model_path: Path | None, frames: int, every: int, rooms: bool, progress: Progress) -> str:
    """Evaluate a model (None: the shipped one) on ``frames`` rendered frames a setting and every n-th real frame.

    A data set that is missing is said so in the report instead of its figures.
    """
    model, config = load_model(model_path), BodyConfig()
    smooth, single = BodyTracker(model, config), BodyTracker(model, single_frame(config))

    def run(name: str, tracker: BodyTracker, source: Iterable[Truth], count: int) -> Answers:
        done = 0

        def advance() -> None:
            nonlocal done
            done += 1
            progress(name, done / count)

        return run_tracker(tracker, source, advance)

    sections = ["# Body tracker: evaluation"]
    settings = [("640x480, background removed", 640, 480, False), ("320x240, background removed", 320, 240, False)]
    if rooms:
        settings.append(("640x480, in a room", 640, 480, True))
    try:
        for name, width, height, room in settings:
            answers = run(name, single, rendered(frames, width, height, room), frames)
            none = float((answers.area_px == 0).mean())
            sections += [
                f"## Rendered people, {name}",
                f"{frames} single frames, no filter; nobody found in {100 * none:.1f} %.",
                joint_table(answers),
                angle_table(answers, AngleConfig()),
            ]
        sections += _times(smooth, frames, progress)
    except DataError as error:
        sections += ["## Rendered people", f"Left out: {error}"]
    try:
        for name, tracker in (("with the filter", smooth), ("single frames", single)):
            answers = run(f"real, {name}", tracker, real(every), -(-2227 // every))
            sections += [f"## Real Kinect v1, {name}", _real_table(answers)]
    except DataError as error:
        sections += ["## Real Kinect v1", f"Left out: {error}"]
    return "\n\n".join(sections) + "\n"


def _times(tracker: BodyTracker, frames: int, progress: Progress) -> list[str]:
    picked = []
    for frame, _, _, _ in rendered(frames, 640, 480, room=False):
        area = int((frame.depth_mm > 0).sum())
        if TIMED_PX[0] <= area <= TIMED_PX[1]:
            picked.append((frame, area))
    seconds = time_stages(tracker, (frame for frame, _ in islice(picked, 20)), 20)
    progress("times", 1.0)
    if len(seconds) == 0:
        return []
    return ["## Time, 640x480, one thread", time_table(seconds, int(np.mean([area for _, area in picked])))]


def _real_table(answers: Answers) -> str:
    """Trusted upper-body joints within 10 cm of the other tracker, by subject, then each joint of all subjects."""
    rows = []
    for subject in sorted(set(answers.group.tolist())):
        part = answers.of_group(subject)
        rows.append(
            [f"subject {subject}", str(len(part.group)), f"{100 * near_share(figures_of(part), UPPER_BODY):.1f}"]
        )
    rows.append(["all", str(len(answers.group)), f"{100 * near_share(figures_of(answers), UPPER_BODY):.1f}"])
    head = table(("", "frames", "trusted upper-body joints within 10 cm %"), rows)
    return head + "\n\n" + joint_table(answers)
