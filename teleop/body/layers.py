"""Layers of a small convolutional network at run time: a few images, one thread, no framework.

A convolution is an unfolding and one matrix product. Images are (N, rows, columns, channels), float32.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba as nb
import numpy as np
import numpy.typing as npt
from threadpoolctl import ThreadpoolController

F32 = npt.NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class Convolution:
    """One convolution, batch normalisation folded in, then a cut at zero.

    kernel: (size * size * inputs, outputs), rows by kernel row, kernel column, channel. bias: (outputs,).
    size, stride: in pixels. residual: the input is added to the output (equal shapes).
    """

    kernel: F32
    bias: F32
    size: int
    stride: int
    residual: bool = False


@nb.njit(cache=True, nogil=True)
def unfold(images: F32, size: int, stride: int, rows: int, columns: int, top: int, left: int) -> F32:
    """Windows (N * rows * columns, size * size * channels) of the images, zero beyond their edges."""
    count, height, width, channels = images.shape
    run = size * channels
    wide = size * run
    out = np.zeros(count * rows * columns * wide, np.float32)
    flat = images.reshape(-1)
    for n in range(count):
        for y in range(rows):
            for i in range(size):
                r = y * stride + i - top
                if r < 0 or r >= height:
                    continue
                for x in range(columns):
                    c = x * stride - left
                    low, high = max(-c, 0), min(size, width - c)
                    # a window's row is one run of memory; unsigned indices cannot be negative, so it is copied as one
                    to = np.uint64(((n * rows + y) * columns + x) * wide + i * run + low * channels)
                    of = np.uint64(((n * height + r) * width + c + low) * channels)
                    for k in range(np.uint64((high - low) * channels)):
                        out[to + k] = flat[of + k]
    return out.reshape(count * rows * columns, wide)


@nb.njit(cache=True, nogil=True)
def rectify(values: F32, bias: F32) -> None:
    """Add the bias (outputs,) to each row of values (N, outputs) and cut at zero, in place."""
    for row in range(values.shape[0]):
        for k in range(values.shape[1]):
            values[row, k] = max(values[row, k] + bias[k], np.float32(0))


def one_thread_products() -> None:
    """Keep matrix products of this process to one thread: these are too small to share, and threads that wait for
    each other on busy cores made them ten times slower."""
    ThreadpoolController().limit(limits=1, user_api="blas")


def convolve(layer: Convolution, images: F32) -> F32:
    """The layer's output (N, ceil(rows / stride), ceil(columns / stride), outputs), "same" padding."""
    count, height, width, _ = images.shape
    rows, columns = -(-height // layer.stride), -(-width // layer.stride)
    top = max((rows - 1) * layer.stride + layer.size - height, 0) // 2
    left = max((columns - 1) * layer.stride + layer.size - width, 0) // 2
    out = unfold(images, layer.size, layer.stride, rows, columns, top, left) @ layer.kernel
    rectify(out, layer.bias)
    out = out.reshape(count, rows, columns, -1)
    return out + images if layer.residual else out
