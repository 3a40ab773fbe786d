"""Layers of a small convolutional network at run time: a few images, one thread, no framework.

A convolution is an unfolding and one matrix product. A stack of them is one compiled call that holds no lock, so that
another thread can work meanwhile. Images are (N, rows, columns, channels), float32.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numba as nb
import numpy as np
import numpy.typing as npt
import scipy.linalg  # noqa: F401 - its BLAS makes the products inside compiled code, and is to be limited below
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


@dataclass(frozen=True, slots=True, eq=False)
class Stack:
    """Convolutions one after another."""

    layers: tuple[Convolution, ...]
    kernels: tuple[F32, ...] = field(init=False)
    biases: tuple[F32, ...] = field(init=False)
    shape: npt.NDArray[np.int64] = field(init=False)

    def __post_init__(self) -> None:
        rows = [(layer.size, layer.stride, int(layer.residual)) for layer in self.layers]
        object.__setattr__(self, "kernels", tuple(np.ascontiguousarray(x.kernel, np.float32) for x in self.layers))
        object.__setattr__(self, "biases", tuple(np.ascontiguousarray(x.bias, np.float32) for x in self.layers))
        object.__setattr__(self, "shape", np.array(rows, np.int64).reshape(-1, 3))

    def parts(self) -> tuple[tuple[F32, ...], tuple[F32, ...], npt.NDArray[np.int64]]:
        """What run_stack takes."""
        return self.kernels, self.biases, self.shape

    def __call__(self, images: F32) -> F32:
        """The last layer's output (N, rows, columns, outputs); "same" padding, rows = ceil(rows / stride) a layer."""
        if not self.layers:
            return images
        out: F32 = run_stack(np.ascontiguousarray(images), self.kernels, self.biases, self.shape)
        return out


@nb.njit(cache=True, nogil=True)
def _unfold(images: F32, size: int, stride: int, rows: int, columns: int, top: int, left: int, out: F32) -> None:
    """Windows (N * rows * columns, size * size * channels) of the images, zero beyond their edges, row by row."""
    count, height, width, channels = images.shape
    run = size * channels
    wide = size * run
    flat = images.reshape(-1)
    for n in range(count):
        for y in range(rows):
            for i in range(size):
                r = y * stride + i - top
                outside = r < 0 or r >= height
                for x in range(columns):
                    c = x * stride - left
                    low, high = max(-c, 0), min(size, width - c)
                    # a window's row is one run of memory; unsigned indices cannot be negative, so it is copied as one
                    begin = np.uint64(((n * rows + y) * columns + x) * wide + i * run)
                    if outside or low > 0 or high < size:
                        for k in range(np.uint64(run)):
                            out[begin + k] = np.float32(0)
                        if outside:
                            continue
                    to = begin + np.uint64(low * channels)
                    of = np.uint64(((n * height + r) * width + c + low) * channels)
                    for k in range(np.uint64((high - low) * channels)):
                        out[to + k] = flat[of + k]


@nb.njit(cache=True, nogil=True)
def rectify(values: F32, bias: F32) -> None:
    """Add the bias (outputs,) to each row of values (N, outputs) and cut at zero, in place."""
    for row in range(values.shape[0]):
        for k in range(values.shape[1]):
            values[row, k] = max(values[row, k] + bias[k], np.float32(0))


@nb.njit(cache=True, nogil=True)
def _add(values: F32, more: F32) -> None:
    for k in range(len(values)):
        values[k] += more[k]


@nb.njit(cache=True, nogil=True)
def run_stack(images: F32, kernels: tuple[F32, ...], biases: tuple[F32, ...], shape: npt.NDArray[np.int64]) -> F32:
    """All layers of a stack; arguments as in Stack."""
    for layer in range(len(shape)):
        size, stride, residual = shape[layer]
        count, height, width, _ = images.shape
        rows, columns = -(-height // stride), -(-width // stride)
        top = max((rows - 1) * stride + size - height, 0) // 2
        left = max((columns - 1) * stride + size - width, 0) // 2
        kernel = kernels[layer]
        windows = np.empty(count * rows * columns * kernel.shape[0], np.float32)
        _unfold(images, size, stride, rows, columns, top, left, windows)
        values = np.dot(windows.reshape(-1, kernel.shape[0]), kernel)
        rectify(values, biases[layer])
        if residual:
            _add(values.reshape(-1), images.reshape(-1))
        images = values.reshape(count, rows, columns, kernel.shape[1])
    return images


@nb.njit(cache=True, nogil=True)
def run_dense(
    values: F32, first: F32, first_bias: F32, second: F32, second_bias: F32, last: F32, last_bias: F32
) -> F32:
    """Three full layers over rows (N, inputs), cut at zero between them."""
    hidden = np.dot(values, first)
    rectify(hidden, first_bias)
    hidden = np.dot(hidden, second)
    rectify(hidden, second_bias)
    out = np.dot(hidden, last)
    for row in range(out.shape[0]):
        for k in range(out.shape[1]):
            out[row, k] += last_bias[k]
    return out


def one_thread_products() -> None:
    """Keep matrix products of this process to one thread: these are too small to share, and threads that wait for
    each other on busy cores made them ten times slower."""
    ThreadpoolController().limit(limits=1, user_api="blas")
