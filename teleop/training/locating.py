"""Training the coarse network (teleop.body.coarse): a crop of the operator in, all joints out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from teleop.body.coarse import N_OUTPUTS, REACH_M, SPREAD_M, CoarseNet, anchor_places, places, to_crop
from teleop.body.crop import WHOLE, crop_cells
from teleop.body.features import FAR_MM
from teleop.body.layers import F32
from teleop.errors import ModelError
from teleop.joints import MIRROR_JOINT, N_JOINTS
from teleop.training.bodies import Bodies, body_image
from teleop.training.build import Progress
from teleop.training.network import LoopSpec, convolution, folded, tensorflow, train

_BLOCKS: Final = ((16, 5, 2), (32, 3, 2), (32, 3, 1), (64, 3, 2), (64, 3, 1), (64, 3, 1), (64, 3, 1), (64, 3, 1))
"""Outputs, kernel size and stride of each convolution."""
_RESIDUAL: Final = (5, 6, 7)


@dataclass(frozen=True, slots=True)
class CoarseSpec:
    """steps: batches of ``frames`` frames. shift_m: spread of the crop's centre across and in depth, and down.
    hidden_weight: of joints that are not visible. dropout: share of the frames of which some pixels go.
    cut: share of which everything below some row goes."""

    steps: int = 12500
    frames: int = 64
    shift_m: tuple[float, float, float] = (0.06, 0.08, 0.08)
    hidden_weight: float = 0.25
    dropout: float = 0.2
    cut: float = 0.06


def draw(bodies: Bodies, frames: npt.NDArray[np.int64], spec: CoarseSpec, rng: np.random.Generator) -> tuple[F32, ...]:
    """Crops (N, rows, columns, 2), places (N, J, 3) as teleop.body.coarse.to_crop gives them, weights (N, J).

    Half of the frames are mirrored.
    """
    s = WHOLE
    crops = np.empty((len(frames), s.rows, s.columns, 2), np.float32)
    truth = np.empty((len(frames), N_JOINTS, 3), np.float32)
    weights = np.empty((len(frames), N_JOINTS), np.float32)
    for n, f in enumerate(frames):
        image, (width, height) = body_image(bodies, f, spec.dropout, rng), bodies.sizes[f]
        fx, fy, _, _ = bodies.intrinsics[f]
        column, row, depth_m = bodies.centres[f] + rng.normal(0, 1, 3) * np.array([0.0, 0.0, spec.shift_m[2]])
        column += rng.normal(0, spec.shift_m[0]) * fx / depth_m
        row += rng.normal(0, spec.shift_m[1]) * fy / depth_m
        if rng.uniform() < spec.cut:
            image = image.copy()
            image[int(rng.uniform(0.5, 1.0) * height) * width :] = FAR_MM
        mirror = bool(rng.uniform() < 0.5)
        shape = (s.rows, s.columns, s.cell_m, s.unit_m, s.near, s.far)
        crops[n] = crop_cells(image, 0, int(width), int(height), column, row, depth_m, fx, fy, mirror, *shape)
        place = to_crop(bodies.joints_m[f], (column, row, depth_m), bodies.intrinsics[f])
        weight = np.where(bodies.visible[f], 1.0, spec.hidden_weight)
        if mirror:
            place, weight = place[list(MIRROR_JOINT)] * np.array([-1.0, 1.0, 1.0]), weight[list(MIRROR_JOINT)]
        truth[n], weights[n] = place, weight
    return crops, truth, weights


def _batches(bodies: Bodies, spec: CoarseSpec, seed: int) -> Iterator[tuple[F32, ...]]:
    rng = np.random.default_rng([seed, 2])
    while True:
        order = rng.permutation(len(bodies))
        for first in range(0, len(order) - spec.frames + 1, spec.frames):
            yield draw(bodies, order[first : first + spec.frames], spec, rng)


def network(tf: Any) -> Any:
    """The untrained network: crop to (anchors, J, N_OUTPUTS)."""
    layers = tf.keras.layers
    crop = x = layers.Input((WHOLE.rows, WHOLE.columns, 2))
    for n, (outputs, size, stride) in enumerate(_BLOCKS):
        y = convolution(tf, x, outputs, size, stride)
        x = layers.Add()([x, y]) if n in _RESIDUAL else y
    x = layers.Conv2D(N_JOINTS * N_OUTPUTS, 1)(x)
    return tf.keras.Model(crop, layers.Reshape((-1, N_JOINTS, N_OUTPUTS))(x))


def vote(tf: Any, model: Any, out: Any) -> tuple[Any, Any]:
    """Places (N, J, 3) and log spreads (N, J) of the anchors' votes."""
    rows, columns = (int(n) for n in model.layers[-2].output.shape[1:3])
    anchors = anchor_places(rows, columns)[:, None, :]
    weight = tf.nn.softmax(out[..., 0], axis=1)[..., None]
    offsets = out[..., 1:4] * REACH_M
    there = tf.concat([offsets[..., :2] + anchors, offsets[..., 2:]], -1)
    return tf.reduce_sum(weight * there, 1), tf.reduce_sum(weight[..., 0] * out[..., 4], 1)


def runtime(model: Any) -> CoarseNet:
    """The trained network in the form of the run time."""
    kernel, bias = model.layers[-2].get_weights()
    head = np.ascontiguousarray(kernel.reshape(kernel.shape[-2], -1))
    return CoarseNet(folded(model, _RESIDUAL), head, bias)


def train_coarse(bodies: Bodies, spec: CoarseSpec, seed: int, progress: Progress) -> CoarseNet:
    """Train from frames and a seed. Raises ModelError when TensorFlow is missing, when the training diverges or when
    the run time's answers are not those of the trained network."""
    tf = tensorflow(seed)
    model = network(tf)

    def loss(crops: Any, truth: Any, weights: Any) -> Any:
        found, log_spread = vote(tf, model, model(crops, training=True))
        error = tf.sqrt(tf.reduce_sum((found - truth) ** 2, -1) + 1e-5) / SPREAD_M
        # the likelihood of an error whose density falls exponentially with its length teaches the spread
        likelihood = error / tf.exp(log_spread) + 3.0 * log_spread
        return tf.reduce_mean(weights * (error + 0.3 * likelihood))

    train(tf, model, loss, _batches(bodies, spec, seed), LoopSpec(spec.steps), "coarse network", progress)
    net = runtime(model)
    crops = draw(bodies, np.arange(1), spec, np.random.default_rng(seed))[0]
    wanted = np.asarray(vote(tf, model, model(crops, training=False))[0])[0]
    difference = float(np.abs(places(net, crops[0])[0] - wanted).max())
    if difference > 1e-4:
        raise ModelError(f"the coarse network's run time is off by {1000 * difference:.2f} mm from what was trained")
    return net
