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

from teleop.body.layers import F32, Convolution, convolve

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

    coming: tuple[Convolution, ...]
    deep: tuple[Convolution, ...]
    up: F32
    side: F32
    bias: F32
    last: Convolution
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
def _join(fine: F32, coarse: F32, bias: F32) -> F32:
    """fine (h, w, C) plus coarse (h / 2, w / 2, C), each value over two by two, plus bias, cut at zero."""
    h, w, channels = fine.shape
    out = np.empty((1, h, w, channels), np.float32)
    for r in range(h):
        for c in range(w):
            for k in range(channels):
                out[0, r, c, k] = max(fine[r, c, k] + coarse[r // 2, c // 2, k] + bias[k], np.float32(0))
    return out


@nb.njit(cache=True, nogil=True)
def _spread(logits: F32, rows: int, columns: int) -> F32:
    """Probabilities (rows, columns) from logits (h, w, BLOCK * BLOCK)."""
    out = np.empty((rows, columns), np.float32)
    for r in range(rows):
        for c in range(columns):
            k = (r % BLOCK) * BLOCK + c % BLOCK
            out[r, c] = np.float32(1.0) / (np.float32(1.0) + np.exp(-logits[r // BLOCK, c // BLOCK, k]))
    return out


def person_cells(finder: Finder, grid_mm: npt.NDArray[np.uint16]) -> F32:
    """Probability (h, w) that a cell of the decimated depth image (h, w) [mm] shows a person."""
    h, w = grid_mm.shape
    x = finder_input(grid_mm, -(-h // _MULTIPLE) * _MULTIPLE, -(-w // _MULTIPLE) * _MULTIPLE)
    for layer in finder.coming:
        x = convolve(layer, x)
    y = x
    for layer in finder.deep:
        y = convolve(layer, y)
    joined = convolve(finder.last, _join(x[0] @ finder.side, y[0] @ finder.up, finder.bias))
    return _spread(joined[0] @ finder.head + finder.head_bias, h, w)
