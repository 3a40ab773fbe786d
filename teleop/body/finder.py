"""Where people are: a small convolutional network over the decimated depth image tells people from things, by cell.

It parts an operator from the table they lean on, which no depth step does, and knows that a coat on a stand is none.
Encoder and decoder with one shortcut (after Ronneberger et al., MICCAI 2015), trained on rendered scenes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.exponent import exp_in_place
from teleop.body.grid import Window
from teleop.body.layers import F32, Stack, run_stack

BLOCK: Final = 4
"""The last layer answers for BLOCK x BLOCK cells of the grid at once."""
_MULTIPLE: Final = 8
NEAR_M: Final = 0.4
FAR_M: Final = 6.0
_MIDDLE_M: Final = 2.4
_UNIT_M: Final = 1.5


@dataclass(frozen=True, slots=True, eq=False)
class Finder:
    """The network. coming: two convolutions down to a quarter of the grid, whose output the way back sees again;
    deep: down to an eighth, the last ones residual. up: (deep channels, C), side: (coming channels, C) and bias (C,):
    what joins both. last: a residual convolution. head: (C, BLOCK * BLOCK), head_bias."""

    coming: Stack
    deep: Stack
    up: F32
    side: F32
    bias: F32
    last: Stack
    head: F32
    head_bias: F32


@nb.njit(cache=True, nogil=True)
def finder_input(grid_mm: npt.NDArray[np.uint16], rows: int, columns: int) -> F32:
    """What the network sees (1, rows, columns, 2): scaled depth, zero where nothing is read, and whether it is."""
    out = np.zeros((1, rows, columns, 2), np.float32)
    scale = np.float32(1.0 / _UNIT_M)
    for r in range(grid_mm.shape[0]):
        for c in range(grid_mm.shape[1]):
            z = np.float32(grid_mm[r, c]) * np.float32(1e-3)
            if NEAR_M < z < FAR_M:
                out[0, r, c, 0] = (z - np.float32(_MIDDLE_M)) * scale
                out[0, r, c, 1] = 1.0
    return out


@nb.njit(cache=True, nogil=True)
def _join(fine: F32, coarse: F32, bias: F32, out: F32) -> None:
    for k in range(np.uint64(len(bias))):
        out[k] = max(fine[k] + coarse[k] + bias[k], np.float32(0))


@nb.njit(cache=True, nogil=True)
def _sigmoids(logits: F32, bias: F32) -> None:
    """Logits (N, C) without their bias (C,) to probabilities, in place."""
    for row in range(logits.shape[0]):
        for k in range(logits.shape[1]):
            logits[row, k] = -(logits[row, k] + bias[k])
    flat = logits.reshape(-1)
    exp_in_place(flat, np.empty(len(flat), np.int32))
    for i in range(np.uint64(len(flat))):
        flat[i] = np.float32(1) / (np.float32(1) + flat[i])


@nb.njit(cache=True, nogil=True)
def by_cell(blocks: F32, across: int, high: int, wide: int) -> F32:
    """Values (high, wide) cell by cell, of blocks (N, BLOCK * BLOCK), ``across`` of them side by side."""
    out = np.empty((high, wide), np.float32)
    for r in range(high):
        block, first = (r // BLOCK) * across, (r % BLOCK) * BLOCK
        for column in range((wide + BLOCK - 1) // BLOCK):
            for k in range(min(BLOCK, wide - column * BLOCK)):
                out[r, column * BLOCK + k] = blocks[block + column, first + k]
    return out


@nb.njit(cache=True, nogil=True)
def _run(
    grid_mm: npt.NDArray[np.uint16],
    rows: int,
    columns: int,
    coming: tuple[tuple[F32, ...], tuple[F32, ...], npt.NDArray[np.int64]],
    deep: tuple[tuple[F32, ...], tuple[F32, ...], npt.NDArray[np.int64]],
    last: tuple[tuple[F32, ...], tuple[F32, ...], npt.NDArray[np.int64]],
    joining: tuple[F32, F32, F32],
    head: F32,
    head_bias: F32,
) -> F32:
    x = run_stack(finder_input(grid_mm, rows, columns), coming[0], coming[1], coming[2])
    y = run_stack(x, deep[0], deep[1], deep[2])
    up, side, bias = joining
    _, h, w, _ = x.shape
    fine = np.dot(x.reshape(-1, x.shape[3]), side).reshape(h, w, -1)
    coarse = np.dot(y.reshape(-1, y.shape[3]), up).reshape(y.shape[1], y.shape[2], -1)
    joined = np.empty((1, h, w, len(bias)), np.float32)
    for r in range(h):
        for c in range(w):
            _join(fine[r, c], coarse[r // 2, c // 2], bias, joined[0, r, c])
    joined = run_stack(joined, last[0], last[1], last[2])
    logits = np.dot(joined.reshape(-1, joined.shape[3]), head)
    _sigmoids(logits, head_bias)
    return by_cell(logits, w, grid_mm.shape[0], grid_mm.shape[1])


def person_cells(finder: Finder, grid_mm: npt.NDArray[np.uint16], window: Window | None = None) -> F32:
    """Probability (h, w) that a cell of the decimated depth image (h, w) [mm] shows a person.

    window: the part of the grid that is looked at, widened to whole multiples of cells; zero elsewhere.
    """
    if window is not None:
        out = np.zeros(grid_mm.shape, np.float32)
        (r0, c0), (r1, c1) = (np.array(window[:2]) // _MULTIPLE * _MULTIPLE, np.array(window[2:]))
        out[r0:r1, c0:c1] = person_cells(finder, np.ascontiguousarray(grid_mm[r0:r1, c0:c1]))
        return out
    h, w = grid_mm.shape
    rows, columns = -(-h // _MULTIPLE) * _MULTIPLE, -(-w // _MULTIPLE) * _MULTIPLE
    coming, deep, last = (s.parts() for s in (finder.coming, finder.deep, finder.last))
    joining = (finder.up, finder.side, finder.bias)
    cells: F32 = _run(grid_mm, rows, columns, coming, deep, last, joining, finder.head, finder.head_bias)
    return cells
