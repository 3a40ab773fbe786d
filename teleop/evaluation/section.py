"""What every part of the evaluation gets and gives."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from teleop.config import TeleopConfig
from teleop.evaluation.answers import Answers, Tracker, run_tracker
from teleop.evaluation.store import FrameSet, FrameStore

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BATCHES_A_SEED: Final = 1000
"""A multiple of ten, for the ten testers."""
Progress = Callable[[str, float], None]
"""Called with what is being done and the share 0..1 of it that is done."""


@dataclass(frozen=True, slots=True)
class Bench:
    """What is measured, and on how much.

    single: the tracker without, smooth: with its temporal filter. frames: of one setting, the rest in proportion.
    seed: other people, poses and rooms for another one.
    """

    single: Tracker
    smooth: Tracker
    config: TeleopConfig
    store: FrameStore
    frames: int
    progress: Progress
    seed: int = 0

    def run(self, name: str, frames: FrameSet, batches: int, *, single: bool = True) -> Answers:
        """Track rendered frames, batch by batch. Raises DataError when the people's data set is missing."""
        with self.counting(name, batches) as advance:
            tracker = self.single if single else self.smooth
            cases = self.store.cases(frames, batches, advance, self.seed * BATCHES_A_SEED)
            return run_tracker(tracker, cases, single=single)

    @contextmanager
    def counting(self, name: str, total: int) -> Iterator[Callable[[], None]]:
        """A function to call ``total`` times that moves the progress bar ``name``."""
        done = 0

        def advance() -> None:
            nonlocal done
            done += 1
            self.progress(name, done / max(1, total))

        self.progress(name, 0.0)
        yield advance
        self.progress(name, 1.0)


@dataclass(frozen=True, slots=True)
class Section:
    """One part of the report. text: Markdown. figures: name to number, for machines. plots: file stem to drawing."""

    title: str
    text: str
    figures: dict[str, float]
    plots: Mapping[str, Callable[[], Figure]] = field(default_factory=dict)


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [head, ["---", *["---:"] * (len(head) - 1)], *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


def percent(share: float) -> str:
    """A share as percent."""
    return f"{100 * share:.1f}"
