"""Training the refiner (teleop.body.refine): depth round noisy joints in, the way back to the true joint out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from teleop.body.crop import LOCAL
from teleop.body.layers import F32
from teleop.body.refine import IS_LEFT, KIND, KINDS, N_NEAR, SPREAD_M, STEP_M, Floats, Refiner, joint_crops, moves
from teleop.body.refine import near_vectors as near_of
from teleop.errors import ModelError
from teleop.joints import JOINT_NAMES, N_JOINTS
from teleop.training.bodies import Bodies, body_image
from teleop.training.build import Progress
from teleop.training.network import LoopSpec, convolution, folded, tensorflow, train

SHAPE: Final = (LOCAL.rows, LOCAL.columns, LOCAL.cell_m, LOCAL.unit_m, LOCAL.near, LOCAL.far)
_HARD: Final = {"wrist": 1.5, "hand": 1.7, "elbow": 1.2, "ankle": 1.1, "foot": 1.3}
"""How much farther off than other joints these are before the refiner."""
_OFTEN: Final = ("wrist", "hand", "elbow", "shoulder")
"""Joints that drive the robot are drawn twice as often."""


@dataclass(frozen=True, slots=True)
class RefinerSpec:
    """steps: batches of ``frames`` frames with ``joints`` joints each. noise_m: median distance of the joints shown
    from the true ones, noise_spread its logarithmic spread. hidden_weight: of joints that are not visible. dropout:
    share of the frames of which some pixels go."""

    steps: int = 12000
    frames: int = 40
    joints: int = 8
    noise_m: float = 0.022
    noise_spread: float = 0.6
    hidden_weight: float = 0.2
    dropout: float = 0.2


def _share(names: tuple[str, ...], value: float) -> Floats:
    return np.array([value if name.rsplit("_", 1)[0] in names else 1.0 for name in JOINT_NAMES])


_NOISE: Final = np.prod([_share((name,), factor) for name, factor in _HARD.items()], axis=0)
_CHANCE: Final = _share(_OFTEN, 2.0) / _share(_OFTEN, 2.0).sum()


def disturbed(joints_m: Floats, spec: RefinerSpec, rng: np.random.Generator) -> Floats:
    """Joints (20, 3) as badly known as the stages before leave them."""
    scale = spec.noise_m * np.exp(rng.normal(0.0, spec.noise_spread))
    return joints_m + rng.normal(0, scale, (N_JOINTS, 3)) * _NOISE[:, None] + rng.normal(0, 0.012, 3)


def draw(bodies: Bodies, frames: npt.NDArray[np.int64], spec: RefinerSpec, rng: np.random.Generator) -> tuple[F32, ...]:
    """Crops (N, rows, columns, 2), vectors to the neighbours (N, 3 N_NEAR), kinds (N, K) one-hot, ways back (N, 3) in
    the orientation of the crops and weights (N,), with N = frames times joints."""
    crops, near, kinds, ways, weights = [], [], [], [], []
    for f in frames:
        chosen = rng.choice(N_JOINTS, spec.joints, replace=False, p=_CHANCE)
        seen = disturbed(bodies.joints_m[f], spec, rng)
        if (seen[:, 2] < 0.3).any():
            continue
        left = IS_LEFT[chosen]
        image, (width, height) = body_image(bodies, f, spec.dropout, rng), bodies.sizes[f]
        crops.append(joint_crops(image, 0, int(width), int(height), bodies.intrinsics[f], seen[chosen], left, SHAPE))
        way = (bodies.joints_m[f] - seen)[chosen]
        way[left, 0] *= -1.0
        ways.append(way)
        near.append(near_of(seen)[chosen])
        kinds.append(np.eye(len(KINDS))[KIND[chosen]])
        weights.append(np.where(bodies.visible[f, chosen], 1.0, spec.hidden_weight))
    columns = (crops, near, kinds, ways, weights)
    return tuple(np.concatenate(column).astype(np.float32) for column in columns)


def _batches(bodies: Bodies, spec: RefinerSpec, seed: int) -> Iterator[tuple[F32, ...]]:
    rng = np.random.default_rng([seed, 1])
    while True:
        order = rng.permutation(len(bodies))
        for first in range(0, len(order) - spec.frames + 1, spec.frames):
            yield draw(bodies, order[first : first + spec.frames], spec, rng)


def _network(tf: Any) -> Any:
    layers = tf.keras.layers
    crop = x = layers.Input((LOCAL.rows, LOCAL.columns, 2))
    near, kind = layers.Input((3 * N_NEAR,)), layers.Input((len(KINDS),))
    for outputs, size in ((16, 5), (32, 3), (48, 3)):
        x = convolution(tf, x, outputs, size, 2)
    x = layers.Concatenate()([layers.Flatten()(x), near, kind])
    x = layers.Dense(160, activation="relu")(x)
    x = layers.Dense(96, activation="relu")(x)
    x = layers.Reshape((len(KINDS), 4))(layers.Dense(len(KINDS) * 4)(x))
    x = tf.keras.ops.sum(x * tf.keras.ops.expand_dims(kind, -1), axis=1)
    return tf.keras.Model([crop, near, kind], x)


def _refiner(model: Any) -> Refiner:
    """The trained network in the form of the run time: the one-hot kind becomes one bias, one last layer a kind."""
    (first, first_bias), (second, second_bias), (last, last_bias) = (
        layer.get_weights() for layer in model.layers if type(layer).__name__ == "Dense"
    )
    kinds = len(KINDS)
    return Refiner(
        convolutions=folded(model),
        first=np.ascontiguousarray(first[:-kinds]),
        first_bias=np.ascontiguousarray(first_bias + first[-kinds:]),
        second=np.ascontiguousarray(second),
        second_bias=second_bias,
        last=np.ascontiguousarray(last.reshape(-1, kinds, 4).transpose(1, 0, 2)),
        last_bias=np.ascontiguousarray(last_bias.reshape(kinds, 4)),
    )


def train_refiner(bodies: Bodies, spec: RefinerSpec, seed: int, progress: Progress) -> Refiner:
    """Train from frames and a seed. Raises ModelError when TensorFlow is missing, when the training diverges or when
    the run time's answers are not those of the trained network."""
    tf = tensorflow(seed)
    model = _network(tf)

    def loss(crops: Any, near: Any, kinds: Any, ways: Any, weights: Any) -> Any:
        out = model([crops, near, kinds], training=True)
        error = tf.sqrt(tf.reduce_sum((out[:, :3] * STEP_M - ways) ** 2, -1) + 1e-6) / SPREAD_M
        # the likelihood of an error whose density falls exponentially with its length teaches the spread
        likelihood = error / tf.exp(out[:, 3]) + 3.0 * out[:, 3]
        return tf.reduce_mean(weights * (error + 0.2 * likelihood))

    train(tf, model, loss, _batches(bodies, spec, seed), LoopSpec(spec.steps), "refiner", progress)
    refiner = _refiner(model)
    _check(model, refiner, bodies)
    return refiner


def _check(model: Any, refiner: Refiner, bodies: Bodies) -> None:
    width, height = bodies.sizes[0]
    joints = bodies.joints_m[0]
    place = (bodies.flat_mm, int(bodies.starts[0]), int(width), int(height), bodies.intrinsics[0])
    crops, near = joint_crops(*place, joints, IS_LEFT, SHAPE), near_of(joints)
    kinds = np.eye(len(KINDS), dtype=np.float32)[KIND]
    wanted = np.asarray(model([crops, near, kinds], training=False))[:, :3] * STEP_M
    difference = float(np.abs(moves(refiner, crops, near, KIND)[0] - wanted).max())
    if difference > 1e-4:
        raise ModelError(f"the refiner's run time is off by {1000 * difference:.2f} mm from what was trained")
