"""Rendered frames are kept chunk by chunk: a run that was cut off goes on, and ends with the same bytes."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from teleop.data import data_root
from teleop.parallel import Outcome
from teleop.training import dataset

pytestmark = pytest.mark.skipif(data_root() is None, reason="rendered people need the data sets: TELEOP_DATA")


@pytest.fixture(autouse=True)
def small_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dataset, "CHUNK", 3)


class Here:
    """A pool without workers: every process would load the people anew."""

    workers = 1

    def run(self, work: Callable[[Any], Any], tasks: Sequence[Any]) -> Iterator[Outcome[Any, Any]]:
        for number, task in enumerate(tasks):
            yield Outcome(number, task, work(task))

    def close(self) -> None:
        """Nothing to end."""


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def test_a_run_that_was_cut_off_goes_on(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    whole, cut = tmp_path / "whole", tmp_path / "cut"
    pool = Here()
    assert list(dataset.render_dataset(whole, "train", 8, pool))[-1] == (3, 3)
    first = dataset.render_dataset(cut, "train", 8, pool)
    assert next(first) == (0, 3)
    next(first)
    first.close()  # what an interruption does
    kept = contents(cut)
    assert len(kept) == 1
    assert next(dataset.render_dataset(cut, "train", 8, pool)) == (1, 3)
    assert list(dataset.render_dataset(cut, "train", 8, pool))[-1] == (3, 3)
    assert contents(cut) == contents(whole)
    assert kept.items() <= contents(cut).items()
    frames = dataset.read_chunk(cut, "train", 6)
    assert len(frames) == 3 and (frames.depth_mm > 0).any()

    with caplog.at_level(logging.WARNING):
        list(dataset.render_dataset(cut, "train", 8, pool))
        assert not caplog.records
        path = dataset.chunk_path(cut, "train", 3)
        with np.load(path) as data:
            arrays = dict(data)
        np.savez_compressed(path, **arrays | {"made_by": np.array("an older renderer")})
        list(dataset.render_dataset(cut, "train", 8, pool))
    assert "1 of 3 chunks" in caplog.text
