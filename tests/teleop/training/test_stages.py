"""Stages of a training run are kept, and made anew when anything they depend on has changed."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from teleop.training.stages import Stages


class Work:
    """Counts how often it is done."""

    def __init__(self) -> None:
        self.done = 0

    def __call__(self) -> int:
        self.done += 1
        return 40 + self.done


def kept(stages: Stages, name: str, settings: object, work: Work) -> int:
    return stages.kept(name, settings, work, lambda value: {"value": np.array(value)}, lambda data: int(data["value"]))


def test_a_second_run_goes_on_after_what_was_done(tmp_path: Path) -> None:
    work = Work()
    assert kept(Stages(tmp_path), "first", 1, work) == 41
    again = Stages(tmp_path)
    assert kept(again, "first", 1, work) == 41 and work.done == 1
    assert kept(again, "second", "a", work) == 42


def test_other_settings_here_or_before_are_other_results(tmp_path: Path) -> None:
    work = Work()
    for first, second in ((1, "a"), (2, "a"), (2, "b")):
        stages = Stages(tmp_path)
        kept(stages, "first", first, work)
        kept(stages, "second", second, work)
    assert work.done == 5  # the first stage of the last run was there
    assert not list(tmp_path.glob("*.part"))
