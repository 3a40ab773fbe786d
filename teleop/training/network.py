"""Training a small network with TensorFlow: one loop for all, and what brings a network to the run time."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from teleop.body.layers import Convolution
from teleop.errors import ModelError
from teleop.training.build import Progress

Batch = tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class LoopSpec:
    """steps: batches in all. rate: highest learning rate, reached after a warm-up, then falling as a cosine."""

    steps: int
    rate: float = 2e-3
    warm_up: int = 300
    weight_decay: float = 1e-4
    clip_norm: float = 5.0


def tensorflow(seed: int) -> Any:
    """The module, seeded. Raises ModelError when it is not installed."""
    os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "2")
    try:
        import tensorflow as tf
    except ImportError as error:
        raise ModelError(
            "training the networks needs TensorFlow; install it with: pip install 'greenhouse-teleop[networks]'"
        ) from error
    tf.keras.utils.set_random_seed(seed)
    return tf


def convolution(tf: Any, x: Any, outputs: int, size: int, stride: int) -> Any:
    """Convolution, batch normalisation and cut at zero: one teleop.body.layers.Convolution at run time."""
    x = tf.keras.layers.Conv2D(outputs, size, stride, "same", use_bias=False)(x)
    return tf.keras.layers.ReLU()(tf.keras.layers.BatchNormalization(momentum=0.98)(x))


def folded(model: Any, residual: tuple[int, ...] = ()) -> tuple[Convolution, ...]:
    """The convolutions of a trained model that are followed by batch normalisation, in order.

    residual: which of them add their input to their output.
    """
    layers = list(model.layers)
    kernels = [layer for layer in layers if type(layer).__name__ == "Conv2D" and not layer.use_bias]
    norms = [layer for layer in layers if type(layer).__name__ == "BatchNormalization"]
    out = []
    for n, (conv, norm) in enumerate(zip(kernels, norms, strict=True)):
        gamma, beta, mean, variance = (np.asarray(w, np.float64) for w in norm.get_weights())
        scale = gamma / np.sqrt(variance + norm.epsilon)
        kernel = np.asarray(conv.get_weights()[0], np.float64) * scale
        size, stride = int(conv.kernel_size[0]), int(conv.strides[0])
        flat = kernel.reshape(-1, kernel.shape[-1])
        out.append(
            Convolution(
                np.ascontiguousarray(flat, np.float32),
                (beta - mean * scale).astype(np.float32),
                size,
                stride,
                n in residual,
            )
        )
    return tuple(out)


def _ahead(batches: Iterator[Batch], count: int, depth: int) -> Iterator[Batch]:
    """The first ``count`` batches, up to ``depth`` of them made ahead by another thread."""
    with ThreadPoolExecutor(1) as worker:
        coming = deque(worker.submit(next, batches) for _ in range(min(depth, count)))
        for n in range(count):
            batch = coming.popleft().result()
            if n + depth < count:
                coming.append(worker.submit(next, batches))
            yield batch


def train(
    tf: Any,
    model: Any,
    loss: Callable[..., Any],
    batches: Iterator[Batch],
    spec: LoopSpec,
    name: str,
    progress: Progress,
) -> float:
    """Fit the model's weights in place. loss(*batch) is a scalar tensor. batches: without end.

    Returns the mean loss over the last tenth of the steps.
    """
    schedule = tf.keras.optimizers.schedules.CosineDecay(
        0.0, spec.steps, alpha=0.005, warmup_target=spec.rate, warmup_steps=min(spec.warm_up, spec.steps // 4)
    )
    optimizer = tf.keras.optimizers.AdamW(schedule, weight_decay=spec.weight_decay, clipnorm=spec.clip_norm)

    @tf.function(reduce_retracing=True)
    def step(*batch: Any) -> Any:
        with tf.GradientTape() as tape:
            value = loss(*batch)
        optimizer.apply_gradients(
            zip(tape.gradient(value, model.trainable_variables), model.trainable_variables, strict=True)
        )
        return value

    last: list[float] = []
    for n, batch in enumerate(_ahead(batches, spec.steps, 6)):
        value = float(step(*batch))
        if not np.isfinite(value):
            raise ModelError(f"training of the {name} diverged at step {n}; use a lower learning rate")
        if n >= spec.steps - max(1, spec.steps // 10):
            last.append(value)
        progress(name, (n + 1) / spec.steps)
    return float(np.mean(last))
