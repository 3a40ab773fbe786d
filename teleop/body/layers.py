"""Layers of a small convolutional network at run time: a few images, one thread, no framework.

A convolution is an unfolding and a matrix product, or what teleop.body.winograd makes of it. A stack of them is one
compiled call that holds no lock, so that another thread can work meanwhile. Images are (N, rows, columns, channels),
float32.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt
import scipy.linalg  # noqa: F401 - its BLAS makes the products inside compiled code, and is to be limited below
from threadpoolctl import ThreadpoolController

from teleop.body.winograd import SIZE, convolve, transformed

F32 = npt.NDArray[np.float32]
I16 = npt.NDArray[np.int16]
_WINDOWS: Final = 192
"""Windows that are unfolded at once: more would leave the nearest cache before they are multiplied."""


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
    """Convolutions one after another. kernels: of the layers, those that _by_winograd names transformed."""

    layers: tuple[Convolution, ...]
    kernels: tuple[F32, ...] = field(init=False)
    biases: tuple[F32, ...] = field(init=False)
    shape: npt.NDArray[np.int64] = field(init=False)

    def __post_init__(self) -> None:
        rows = [(layer.size, layer.stride, int(layer.residual)) for layer in self.layers]
        kernels = (transformed(x.kernel) if _by_winograd(x.size, x.stride) else x.kernel for x in self.layers)
        object.__setattr__(self, "kernels", tuple(np.ascontiguousarray(kernel, np.float32) for kernel in kernels))
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
def _by_winograd(size: int, stride: int) -> bool:
    """Whether teleop.body.winograd does it."""
    return size == SIZE and stride == 1


@nb.njit(cache=True, nogil=True)
def _framed(images: F32, top: int, left: int, height: int, width: int) -> F32:
    """The images' numbers, images of (height, width) now with zeros round them."""
    count, rows, columns, channels = images.shape
    out = np.zeros(count * height * width * channels, np.float32)
    flat, run = images.reshape(-1), np.uint64(columns * channels)
    for n in range(count):
        for r in range(rows):
            to = np.uint64(((n * height + r + top) * width + left) * channels)
            of = np.uint64((n * rows + r) * columns * channels)
            # unsigned indices cannot be negative, so runs of memory are copied as such
            for k in range(run):
                out[to + k] = flat[of + k]
    return out


@nb.njit(cache=True, nogil=True)
def _unfold(framed: F32, of: int, line: int, size: int, run: int, step: int, columns: int, to: int, out: F32) -> None:
    """The windows of one row of outputs, one after another from ``to`` on: ``size`` runs of memory, ``line`` apart.

    The first run of every window, then the second of every one: twice as quick as window by window.
    """
    count, apart, along = np.uint64(run), np.uint64(size * run), np.uint64(step)
    for k in range(size):
        at, begin = np.uint64(to + k * run), np.uint64(of + k * line)
        for _ in range(columns):
            for i in range(count):
                out[at + i] = framed[begin + i]
            at += apart
            begin += along


@nb.njit(cache=True, nogil=True)
def _convolve(images: F32, kernel: F32, size: int, stride: int) -> F32:
    """Any convolution without bias (N, rows, columns, outputs), some rows at a time."""
    count, height, width, channels = images.shape
    rows, columns = -(-height // stride), -(-width // stride)
    high, wide = max((rows - 1) * stride + size, height), max((columns - 1) * stride + size, width)
    framed = _framed(images, (high - height) // 2, (wide - width) // 2, high, wide)
    deep, outputs = kernel.shape
    most = max(1, _WINDOWS // columns)
    windows = np.empty(most * columns * deep, np.float32)
    values = np.empty((count * rows * columns, outputs), np.float32)
    for first in range(0, count * rows, most):
        now = min(most, count * rows - first)
        for row in range(now):
            n, y = divmod(first + row, rows)
            of = (n * high + y * stride) * wide * channels
            to = row * columns * deep
            _unfold(framed, of, wide * channels, size, size * channels, stride * channels, columns, to, windows)
        of_all = windows[: now * columns * deep].reshape(-1, deep)
        np.dot(of_all, kernel, values[first * columns : (first + now) * columns])
    return values.reshape(count, rows, columns, outputs)


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
        if _by_winograd(size, stride):
            images = convolve(images, kernels[layer], biases[layer], residual > 0)
            continue
        values = _convolve(images, kernels[layer], size, stride)
        rectify(values.reshape(-1, values.shape[3]), biases[layer])
        if residual:
            _add(values.reshape(-1), images.reshape(-1))
        images = values
    return images


def in_steps(kernel: F32) -> tuple[I16, F32]:
    """The kernel (inputs, outputs) in whole steps, and the step (outputs,) of each column: half the memory.

    A large layer that sees two or three rows is as quick as its kernel is read.
    """
    step = np.maximum(np.abs(kernel).max(axis=0, initial=0.0), 1e-30) / np.iinfo(np.int16).max
    return np.ascontiguousarray(np.round(kernel / step), np.int16), step.astype(np.float32)


@nb.njit(cache=True, nogil=True, fastmath={"contract"})
def multiply_steps(values: F32, steps: I16, step: F32) -> F32:
    """Rows (N, inputs) times a kernel of in_steps: (N, outputs)."""
    count, inputs = values.shape
    out = np.zeros((count + count % 2, len(step)), np.float32)
    for n in range(0, count, 2):
        other = min(n + 1, count - 1)
        for i in range(inputs):
            a, b = values[n, i], values[other, i]
            for k in range(len(step)):
                weight = np.float32(steps[i, k])
                out[n, k] += a * weight
                out[n + 1, k] += b * weight
    for n in range(count):
        for k in range(len(step)):
            out[n, k] *= step[k]
    return out[:count]


@nb.njit(cache=True, nogil=True)
def run_dense(values: F32, first: tuple[I16, F32], second: F32, last: F32, biases: tuple[F32, F32, F32]) -> F32:
    """Three full layers over rows (N, inputs), cut at zero between them. first: see in_steps."""
    hidden = multiply_steps(values, first[0], first[1])
    rectify(hidden, biases[0])
    hidden = np.dot(hidden, second)
    rectify(hidden, biases[1])
    out = np.dot(hidden, last)
    for row in range(out.shape[0]):
        for k in range(out.shape[1]):
            out[row, k] += biases[2][k]
    return out


def one_thread_products() -> None:
    """Keep matrix products of this process to one thread: these are too small to share, and threads that wait for
    each other on busy cores made them ten times slower."""
    ThreadpoolController().limit(limits=1, user_api="blas")
