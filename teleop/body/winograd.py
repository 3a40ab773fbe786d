"""3x3 convolutions of stride 1 with 4 products where 9 would be needed for each output (Lavin and Gray, CVPR 2016).

F(2x2, 3x3): two outputs of a row come from four inputs, ``A^T [(G g) * (B^T d)]``, and the same along columns. What is
left are sixteen matrix products over tiles of 2x2 outputs.
"""

from __future__ import annotations

from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

F32 = npt.NDArray[np.float32]
SIZE: Final = 3
_POINTS: Final = 4
_G: Final = np.array([[1.0, 0.0, 0.0], [0.5, 0.5, 0.5], [0.5, -0.5, 0.5], [0.0, 0.0, 1.0]])
_FIRST: Final = np.array([0, 1, 2, 1])
_SECOND: Final = np.array([2, 2, 1, 3])
_SIGN: Final = np.array([-1.0, 1.0, -1.0, -1.0], np.float32)
"""B^T: each point is one input, or its sum with or difference from another."""


def transformed(kernel: F32) -> F32:
    """The kernel (9 inputs, outputs), rows by kernel row, kernel column, channel, at the 16 points: (16 inputs,
    outputs), rows by point and channel."""
    outputs = kernel.shape[1]
    g = kernel.reshape(SIZE, SIZE, -1, outputs).astype(np.float64)
    points = np.einsum("ua,vb,abio->uvio", _G, _G, g)
    return np.ascontiguousarray(points.reshape(-1, outputs), np.float32)


@nb.njit(cache=True, nogil=True)
def _sum(out: F32, to: int, a: F32, one: int, other: int, sign: np.float32, count: int) -> None:
    n, i, j = np.uint64(to), np.uint64(one), np.uint64(other)
    for k in range(np.uint64(count)):
        out[n + k] = a[i + k] + sign * a[j + k]


@nb.njit(cache=True, nogil=True)
def _two_outputs(out: F32, first: int, second: int, a: F32, at: int, apart: int, count: int) -> None:
    """A^T: outputs from four points that lie ``apart``."""
    n, m, i, d = np.uint64(first), np.uint64(second), np.uint64(at), np.uint64(apart)
    for k in range(np.uint64(count)):
        middle, odd = a[i + d + k], a[i + d + d + k]
        out[n + k] = a[i + k] + middle + odd
        out[m + k] = middle - odd - a[i + d + d + d + k]


@nb.njit(cache=True, nogil=True)
def convolve(images: F32, kernel: F32, bias: F32, residual: bool) -> F32:
    """3x3 convolution of stride 1 with "same" padding, bias, cut at zero; ``residual`` adds the input after that.

    images: (N, rows, columns, inputs). kernel: see transformed. bias: (outputs,).
    """
    count, height, width, inputs = images.shape
    outputs = len(bias)
    down, across = (height + 1) // 2, (width + 1) // 2
    wide, tiles = 2 * across + 2, down * across
    line = wide * inputs
    flat = images.reshape(-1)
    result = np.empty((count, height, width, outputs), np.float32)
    out = result.reshape(-1)
    rows = np.zeros(_POINTS * line, np.float32)
    by_row = np.empty(_POINTS * line, np.float32)
    points = np.empty((_POINTS * _POINTS, tiles, inputs), np.float32)
    products = np.empty((_POINTS * _POINTS, tiles, outputs), np.float32)
    flat_points, flat_products = points.reshape(-1), products.reshape(-1)
    by_column = np.empty(_POINTS * 2 * across * outputs, np.float32)
    pair = np.empty(2 * 2 * across * outputs, np.float32)
    for n in range(count):
        for y in range(down):
            for a in range(_POINTS):
                r = 2 * y - 1 + a
                inside = 0 <= r < height
                to = np.uint64(a * line + inputs)
                of = np.uint64((n * height + r) * width * inputs if inside else 0)
                for k in range(np.uint64(width * inputs)):
                    rows[to + k] = flat[of + k] if inside else np.float32(0)
            for u in range(_POINTS):
                _sum(by_row, u * line, rows, _FIRST[u] * line, _SECOND[u] * line, _SIGN[u], line)
                for x in range(across):
                    at = u * line + 2 * x * inputs
                    for v in range(_POINTS):
                        to = ((u * _POINTS + v) * tiles + y * across + x) * inputs
                        one, other = at + _FIRST[v] * inputs, at + _SECOND[v] * inputs
                        _sum(flat_points, to, by_row, one, other, _SIGN[v], inputs)
        for p in range(_POINTS * _POINTS):
            np.dot(points[p], kernel[p * inputs : (p + 1) * inputs], products[p])
        for y in range(down):
            span = 2 * across * outputs
            for u in range(_POINTS):
                for x in range(across):
                    at = (u * _POINTS * tiles + y * across + x) * outputs
                    to = u * span + 2 * x * outputs
                    _two_outputs(by_column, to, to + outputs, flat_products, at, tiles * outputs, outputs)
            _two_outputs(pair, 0, span, by_column, 0, span, span)
            for a in range(min(2, height - 2 * y)):
                line_at = np.uint64((n * height + 2 * y + a) * width * outputs)
                for x in range(width):
                    to, of = line_at + np.uint64(x * outputs), np.uint64(a * span + x * outputs)
                    for k in range(np.uint64(outputs)):
                        value = max(pair[of + k] + bias[k], np.float32(0))
                        out[to + k] = value + flat[to + k] if residual else value
    return result
