"""People's cells: found on a person, not on what stands beside; windows; odd sizes of the grid."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from teleop.body.finder import BLOCK, Finder, by_cell, person_cells
from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config.body import BodyConfig
from teleop.sources.virtual import open_virtual


@pytest.fixture(scope="module")
def finder() -> Finder:
    found = load_model().finder
    assert found is not None
    return found


@pytest.fixture(scope="module")
def grid_mm() -> np.ndarray:
    """The built-in operator in a room, 160 columns."""
    frame = open_virtual("builtin,fps=15").performance.take(60).frame
    step = frame.depth_mm.shape[1] // 160
    return np.ascontiguousarray(frame.depth_mm[::step, ::step])


def test_the_operator_is_found_and_the_room_is_not(finder: Finder, grid_mm: np.ndarray) -> None:
    cells = person_cells(finder, grid_mm)
    assert cells.shape == grid_mm.shape and (cells >= 0).all() and (cells <= 1).all()
    seen = cells > 0.5
    depth = grid_mm[seen] * 1e-3
    assert seen.sum() > 1000
    assert np.quantile(depth, 0.9) - np.quantile(depth, 0.1) < 0.7  # one body, no wall and no floor


@pytest.mark.parametrize("wall_mm", [0, 1500, 2500, 4000])
def test_an_empty_image_holds_nobody(wall_mm: int) -> None:
    frame = open_virtual("builtin,fps=15").performance.take(60).frame
    bare = replace(frame, depth_mm=np.full_like(frame.depth_mm, wall_mm))
    tracker = BodyTracker(load_model(), BodyConfig())
    assert tracker.step(bare, tracker.initial_state())[0].skeleton is None


def test_in_a_window_the_operator_is_found_as_in_the_whole(finder: Finder, grid_mm: np.ndarray) -> None:
    whole = person_cells(finder, grid_mm) > 0.5
    rows, columns = np.flatnonzero(whole.any(axis=1)), np.flatnonzero(whole.any(axis=0))
    window = (max(0, rows[0] - 15), max(0, columns[0] - 15), rows[-1] + 15, columns[-1] + 15)
    part = person_cells(finder, grid_mm, window) > 0.5
    assert (part != whole).sum() < 0.03 * whole.sum()
    assert not person_cells(finder, grid_mm, (0, 0, 8, 8))[8:, 8:].any()


@pytest.mark.parametrize("size", [(96, 170), (142, 171), (60, 80)])
def test_grids_of_any_size_are_answered_cell_by_cell(finder: Finder, size: tuple[int, int]) -> None:
    assert person_cells(finder, np.full(size, 2000, np.uint16)).shape == size


def test_blocks_of_answers_are_laid_out_cell_by_cell() -> None:
    high, wide, across = 11, 14, 4
    blocks = np.arange(3 * across * BLOCK * BLOCK, dtype=np.float32).reshape(3 * across, BLOCK * BLOCK)
    cells = by_cell(blocks, across, high, wide)
    whole = blocks.reshape(3, across, BLOCK, BLOCK).transpose(0, 2, 1, 3).reshape(3 * BLOCK, across * BLOCK)
    np.testing.assert_array_equal(cells, whole[:high, :wide])
