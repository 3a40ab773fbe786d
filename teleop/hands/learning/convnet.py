"""Training of the hand network: gradients by hand, Adam, in plain numpy. See ``teleop.hands.network`` for the shapes.

Kingma and Ba, "Adam", ICLR 2015; initial weights after He et al., ICCV 2015.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from teleop.hands.network import HIDDEN, KERNELS, STRIDE, Array, Network, columns, shapes

Augment = Callable[[Array, np.random.Generator], Array]
Bools = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Schedule:
    """epochs over the data, samples a step, peak learning rate (warm-up, then cosine), weight decay, dropout."""

    epochs: int = 20
    batch: int = 64
    rate: float = 2e-3
    decay: float = 2e-4
    dropout: float = 0.3
    smoothing: float = 0.02


def initial(layers: int, rng: np.random.Generator) -> Network:
    """Random weights of variance 2 / inputs, zero biases."""
    sizes = shapes(layers)
    weight = tuple((rng.standard_normal(s) * np.sqrt(2.0 / s[0])).astype(np.float32) for s in sizes)
    return Network(weight, tuple(np.zeros(s[1], np.float32) for s in sizes))


def _spread(gradient: Array, kernel: int, shape: tuple[int, ...]) -> Array:
    """The transpose of ``columns``: gradients of neighbourhoods to gradients (N, H, W, C) of pixels."""
    n, h, w, c = shape
    pad = kernel // 2
    out = np.zeros((n, h + 2 * pad, w + 2 * pad, c), np.float32)
    rows, cols = gradient.shape[1:3]
    parts = gradient.reshape(n, rows, cols, kernel, kernel, c)
    for i in range(kernel):
        for j in range(kernel):
            out[:, i : i + STRIDE * rows : STRIDE, j : j + STRIDE * cols : STRIDE] += parts[:, :, :, i, j]
    return out[:, pad : pad + h, pad : pad + w]


def gradients(net: Network, x: Array, target: Array, keep: Array) -> tuple[float, list[Array], list[Array]]:
    """Mean logistic loss and its gradients by weight and bias. target (N,) 0..1; keep (N, HIDDEN): dropout mask."""
    inputs, cols, seen = [], [], x
    for i, kernel in enumerate(KERNELS):
        inputs.append(seen)
        c = columns(seen, kernel)
        cols.append(c)
        seen = np.maximum(c @ net.weight[i] + net.bias[i], 0.0)
    flat = seen.reshape(len(x), -1)
    hidden = np.maximum(flat @ net.weight[3] + net.bias[3], 0.0) * keep
    z = (hidden @ net.weight[4] + net.bias[4])[:, 0]
    loss = float(np.mean(np.logaddexp(0.0, z) - target * z))
    dz = ((1.0 / (1.0 + np.exp(-z)) - target) / len(x)).astype(np.float32)[:, None]
    dw: list[Array] = [np.empty(0, np.float32)] * 5
    db: list[Array] = [np.empty(0, np.float32)] * 5
    dw[4], db[4] = hidden.T @ dz, dz.sum(axis=0)
    d = (dz @ net.weight[4].T) * keep * (hidden > 0)
    dw[3], db[3] = flat.T @ d, d.sum(axis=0)
    back = (d @ net.weight[3].T).reshape(seen.shape)
    for i in (2, 1, 0):
        back = back * (seen > 0)
        rows, width = back.reshape(-1, back.shape[-1]), cols[i].shape[-1]
        dw[i], db[i] = cols[i].reshape(-1, width).T @ rows, rows.sum(axis=0)
        if i:
            back = _spread((rows @ net.weight[i].T).reshape(cols[i].shape), KERNELS[i], inputs[i].shape)
            seen = inputs[i]
    return loss, dw, db


def train(
    net: Network,
    x: npt.NDArray[np.float16],
    openness: Array,
    schedule: Schedule,
    rng: np.random.Generator,
    augment: Augment,
    progress: Callable[[int, float], None],
) -> Network:
    """Adam over patches x (N, draws, SIZE, SIZE, layers): each epoch takes one draw of every sample.

    openness: (N,) what is to be answered, 0..1. progress(epoch, mean loss) is called after each epoch.
    """
    params = [np.array(p) for p in (*net.weight, *net.bias)]
    m, v = [np.zeros_like(p) for p in params], [np.zeros_like(p) for p in params]
    steps, total = 0, max(1, schedule.epochs * (len(x) // schedule.batch))
    target = (schedule.smoothing + (1.0 - 2.0 * schedule.smoothing) * openness).astype(np.float32)
    for epoch in range(schedule.epochs):
        order, losses = rng.permutation(len(x)), []
        for start in range(0, len(x) - schedule.batch + 1, schedule.batch):
            pick = order[start : start + schedule.batch]
            batch = augment(x[pick, rng.integers(x.shape[1], size=len(pick))].astype(np.float32), rng)
            keep = (rng.random((len(pick), HIDDEN)) >= schedule.dropout).astype(np.float32) / (1.0 - schedule.dropout)
            now = Network(tuple(params[:5]), tuple(params[5:]))
            loss, dw, db = gradients(now, batch, target[pick], keep)
            losses.append(loss)
            steps += 1
            rate = schedule.rate * min(1.0, steps / (0.05 * total + 1)) * 0.5 * (1 + np.cos(np.pi * steps / total))
            for k, g in enumerate((*dw, *db)):
                m[k] += 0.1 * (g - m[k])
                v[k] += 0.001 * (g * g - v[k])
                step = (m[k] / (1 - 0.9**steps)) / (np.sqrt(v[k] / (1 - 0.999**steps)) + 1e-8)
                params[k] -= np.float32(rate) * (step + (schedule.decay / schedule.rate * params[k] if k < 5 else 0.0))
        progress(epoch + 1, float(np.mean(losses)))
    return Network(tuple(params[:5]), tuple(params[5:]))


def calibrated(net: Network, logit: npt.NDArray[np.float64], is_open: Bools) -> Network:
    """Platt scaling: scale and offset of the logit by maximum likelihood on answers to what training never saw."""
    from scipy.optimize import minimize

    y = is_open.astype(np.float64)

    def loss(p: npt.NDArray[np.float64]) -> float:
        t = np.exp(p[0]) * logit + p[1]
        return float(np.mean(np.logaddexp(0.0, t) - y * t))

    found = minimize(loss, np.zeros(2), method="Nelder-Mead").x
    return Network(net.weight, net.bias, float(np.exp(found[0])), float(found[1]))
