"""Convolutions at run time against a plain sum over the window."""

from __future__ import annotations

import numpy as np
import pytest

from teleop.body.layers import Convolution, Stack, in_steps, multiply_steps


def plain(images: np.ndarray, layer: Convolution) -> np.ndarray:
    count, height, width, channels = images.shape
    rows, columns = -(-height // layer.stride), -(-width // layer.stride)
    top = max((rows - 1) * layer.stride + layer.size - height, 0) // 2
    left = max((columns - 1) * layer.stride + layer.size - width, 0) // 2
    kernel = layer.kernel.reshape(layer.size, layer.size, channels, -1)
    out = np.zeros((count, rows, columns, kernel.shape[-1]))
    for y in range(rows):
        for x in range(columns):
            for i in range(layer.size):
                for j in range(layer.size):
                    r, c = y * layer.stride + i - top, x * layer.stride + j - left
                    if 0 <= r < height and 0 <= c < width:
                        out[:, y, x] += images[:, r, c] @ kernel[i, j]
    return np.maximum(out + layer.bias, 0)


@pytest.mark.parametrize(
    ("size", "stride", "shape"),
    [
        (5, 2, (9, 12, 2)),
        (5, 2, (40, 44, 2)),
        (3, 2, (8, 7, 4)),
        (3, 2, (1, 1, 4)),
        (5, 1, (6, 7, 3)),
        (3, 1, (6, 5, 3)),
        (3, 1, (7, 8, 17)),
        (3, 1, (1, 1, 2)),
    ],
)
def test_convolution_is_the_sum_over_its_window(size: int, stride: int, shape: tuple[int, int, int]) -> None:
    rng = np.random.default_rng(size + stride)
    images = rng.normal(size=(3, *shape)).astype(np.float32)
    kernel = rng.normal(size=(size * size * shape[2], 6)).astype(np.float32)
    layer = Convolution(kernel, rng.normal(size=6).astype(np.float32), size, stride)
    assert Stack((layer,))(images) == pytest.approx(plain(images, layer), abs=1e-4)


def test_residual_layer_adds_its_input() -> None:
    rng = np.random.default_rng(3)
    images = rng.normal(size=(1, 5, 4, 3)).astype(np.float32)
    layer = Convolution(rng.normal(size=(27, 3)).astype(np.float32), np.zeros(3, np.float32), 3, 1)
    with_input = Convolution(layer.kernel, layer.bias, 3, 1, residual=True)
    assert Stack((with_input,))(images) == pytest.approx(Stack((layer,))(images) + images)


def test_a_stack_is_its_layers_one_after_another() -> None:
    rng = np.random.default_rng(4)
    images = rng.normal(size=(2, 9, 10, 2)).astype(np.float32)
    sizes = ((2, 4, 5, 2, False), (4, 4, 3, 1, True), (4, 6, 3, 2, False))
    layers = tuple(
        Convolution(rng.normal(size=(k * k * i, o)).astype(np.float32), rng.normal(size=o).astype(np.float32), k, s, r)
        for i, o, k, s, r in sizes
    )
    wanted = images
    for layer in layers:
        wanted = Stack((layer,))(wanted)
    assert (Stack(layers)(images) == wanted).all()
    assert Stack(())(images) is images


@pytest.mark.parametrize("rows", [0, 1, 2, 3])
def test_a_kernel_in_steps_multiplies_as_the_kernel_does(rows: int) -> None:
    rng = np.random.default_rng(5)
    kernel = (rng.normal(size=(70, 20)) * np.logspace(-3, 2, 20)).astype(np.float32)
    kernel[:, 3] = 0.0
    values = rng.normal(size=(rows, 70)).astype(np.float32)
    found = multiply_steps(values, *in_steps(kernel))
    assert found.shape == (rows, 20)
    most = np.abs(kernel).max(axis=0)
    assert (np.abs(found - values @ kernel) <= 70 * 2e-5 * most * max(1.0, np.abs(values).max(initial=0.0))).all()
