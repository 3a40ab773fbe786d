"""The whole evaluation, from a model file to a Markdown report, its plots and its figures as JSON."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config import TeleopConfig
from teleop.errors import DataError
from teleop.evaluation.answers import single_frame
from teleop.evaluation.arm_motion import motion_section
from teleop.evaluation.false_persons import nobody_section
from teleop.evaluation.memory import memory_section
from teleop.evaluation.overall import people_section
from teleop.evaluation.recorded import real_section
from teleop.evaluation.robustness import robustness_section
from teleop.evaluation.section import Bench, Progress, Section
from teleop.evaluation.speed import speed_section
from teleop.evaluation.steps import steps_section
from teleop.evaluation.store import FrameStore
from teleop.evaluation.targets import target_table
from teleop.evaluation.testers import testers_section

SECTIONS: Final[dict[str, Callable[[Bench], list[Section]]]] = {
    "people": people_section,
    "motion": motion_section,
    "testers": testers_section,
    "steps": steps_section,
    "robustness": robustness_section,
    "nobody": nobody_section,
    "real": real_section,
    "speed": speed_section,
    "memory": memory_section,
}


@dataclass(frozen=True, slots=True)
class Report:
    """What was measured; left_out: section and the reason."""

    sections: tuple[Section, ...]
    left_out: dict[str, str] = field(default_factory=dict)

    @property
    def figures(self) -> dict[str, float]:
        """All figures of all sections."""
        return {key: value for section in self.sections for key, value in section.figures.items()}

    def markdown(self, head: str) -> str:
        """The report; head: how it was made."""
        parts = ["# Body tracker: evaluation", head, target_table(self.figures)]
        for section in self.sections:
            parts += [f"## {section.title}", section.text, *(f"![{n}]({n}.png)" for n in section.plots)]
        parts += [f"## {name}\n\nLeft out: {why}" for name, why in self.left_out.items()]
        return "\n\n".join(parts) + "\n"

    def write(self, folder: Path, head: str, *, plots: bool) -> Path:
        """evaluation.md, figures.json and, if wanted, one PNG a plot; returns the Markdown's path."""
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / "evaluation.md"
        shown = self if plots else Report(tuple(_bare(s) for s in self.sections), self.left_out)
        path.write_text(shown.markdown(head))
        (folder / "figures.json").write_text(json.dumps(self.figures, indent=1) + "\n")
        for section in shown.sections:
            for name, draw in section.plots.items():
                draw().savefig(folder / f"{name}.png", dpi=110)
        return path


def _bare(section: Section) -> Section:
    return Section(section.title, section.text, section.figures)


def evaluate_model(
    model: Path | None,
    only: Sequence[str],
    frames: int,
    store: FrameStore,
    progress: Progress,
    config: TeleopConfig,
    seed: int = 0,
) -> Report:
    """Measure a model file (None: the shipped one). only: names of SECTIONS.

    A section whose data set is missing is named in the report instead of its figures. Raises ModelError.
    """
    loaded, body = load_model(model), config.body
    single, smooth = BodyTracker(loaded, single_frame(body)), BodyTracker(loaded, body)
    bench = Bench(single, smooth, config, store, frames, progress, seed)
    sections, left_out = [], {}
    for name in only:
        try:
            sections += SECTIONS[name](bench)
        except DataError as error:
            left_out[name] = str(error)
    return Report(tuple(sections), left_out)
