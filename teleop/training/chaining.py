"""Training the limb networks (teleop.body.chains) on what the stages before them leave."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from teleop.body.chains import CHAINS, LINKS, ChainNet, limb_crops, limb_moves, pose_vectors
from teleop.body.coarse import CoarseNet, locate
from teleop.body.crop import LOCAL
from teleop.body.layers import F32
from teleop.body.refine import SPREAD_M, STEP_M, Floats, Refiner, refine
from teleop.errors import ModelError
from teleop.joints import N_JOINTS
from teleop.training.bodies import Bodies, body_image
from teleop.training.build import Progress
from teleop.training.network import LoopSpec, convolution, folded, tensorflow, train

_NAMES: Final = ("arm network", "leg network")
NEAREST_M: Final = 0.3


@dataclass(frozen=True, slots=True)
class ChainSpec:
    """steps: batches of ``frames`` frames with both limbs. shift_m: further noise of each joint. hidden_weight: of
    joints that are not visible. dropout: share of the frames of which some pixels go. direction: weight of the
    directions of the bones beside the places of the joints."""

    steps: int = 12_000
    frames: int = 40
    shift_m: float = 0.006
    hidden_weight: float = 0.2
    dropout: float = 0.2
    direction: float = 0.5


def estimates(bodies: Bodies, coarse: CoarseNet, refiner: Refiner, progress: Progress) -> Floats:
    """Joints (F, 20, 3) of the stages before, for every frame."""
    out = np.empty((len(bodies), N_JOINTS, 3))
    everything = np.arange(N_JOINTS)
    for f in range(len(bodies)):
        width, height = (int(n) for n in bodies.sizes[f])
        flat = bodies.flat_mm[bodies.starts[f] : bodies.starts[f] + width * height]
        joints, _ = locate(coarse, flat, width, height, bodies.intrinsics[f])
        joints[:, 2] = np.maximum(joints[:, 2], NEAREST_M)
        out[f], _ = refine(refiner, flat, width, height, bodies.intrinsics[f], joints, everything)
        progress("joints before the limbs", (f + 1) / len(bodies))
    return out


def draw(
    bodies: Bodies,
    before_m: Floats,
    frames: npt.NDArray[np.int64],
    kind: int,
    spec: ChainSpec,
    rng: np.random.Generator,
) -> tuple[F32, ...]:
    """Crops (N LINKS, rows, columns, 2), poses (N, 3 N_JOINTS), ways back (N, LINKS, 3) in the orientation of the
    crops, the limb as it was seen (N, LINKS, 3) and weights (N, LINKS), with N two limbs a frame."""
    crops, poses, ways, seen, weights = [], [], [], [], []
    sides = np.array([1.0, -1.0])
    for f in frames:
        joints = before_m[f] + rng.normal(0, spec.shift_m * rng.uniform(0, 2), (N_JOINTS, 3))
        joints[:, 2] = np.maximum(joints[:, 2], NEAREST_M)
        image, (width, height) = body_image(bodies, f, spec.dropout, rng), bodies.sizes[f]
        crops.append(limb_crops(image, 0, int(width), int(height), bodies.intrinsics[f], joints, kind))
        poses.append(pose_vectors(joints, kind))
        way, limb = (bodies.joints_m[f] - joints)[CHAINS[kind]], joints[CHAINS[kind]]
        way[..., 0] *= sides[:, None]
        limb[..., 0] *= sides[:, None]
        ways.append(way)
        seen.append(limb - limb[:, :1])
        weights.append(np.where(bodies.visible[f][CHAINS[kind]], 1.0, spec.hidden_weight))
    columns = (crops, poses, ways, seen, weights)
    return tuple(np.concatenate(column).astype(np.float32) for column in columns)


def _batches(bodies: Bodies, before_m: Floats, kind: int, spec: ChainSpec, seed: int) -> Iterator[tuple[F32, ...]]:
    rng = np.random.default_rng([seed, 3, kind])
    while True:
        order = rng.permutation(len(bodies))
        for first in range(0, len(order) - spec.frames + 1, spec.frames):
            yield draw(bodies, before_m, order[first : first + spec.frames], kind, spec, rng)


def _network(tf: Any) -> Any:
    layers = tf.keras.layers
    crop = x = layers.Input((LOCAL.rows, LOCAL.columns, 2))
    for outputs, size in ((16, 5), (32, 3), (32, 3)):
        x = convolution(tf, x, outputs, size, 2)
    eyes = tf.keras.Model(crop, layers.Flatten()(x))
    width = LINKS * eyes.output.shape[-1]
    features, pose = layers.Input((width,)), layers.Input((3 * N_JOINTS,))
    x = layers.Dense(160, activation="relu")(layers.Concatenate()([features, pose]))
    x = layers.Dense(96, activation="relu")(x)
    mind = tf.keras.Model([features, pose], layers.Reshape((LINKS, 4))(layers.Dense(4 * LINKS)(x)))

    class Limbs(tf.keras.Model):  # type: ignore[misc]
        """The eyes look at each crop, the mind at all of a limb."""

        def __init__(self) -> None:
            super().__init__()
            self.eyes, self.mind = eyes, mind

        def call(self, inputs: Any, training: bool = False) -> Any:
            seen = tf.reshape(self.eyes(inputs[0], training=training), (-1, width))
            return self.mind([seen, inputs[1]], training=training)

    return Limbs()


def _runtime(model: Any) -> ChainNet:
    arrays = [w for layer in model.mind.layers if type(layer).__name__ == "Dense" for w in layer.get_weights()]
    return ChainNet(folded(model.eyes), *(np.ascontiguousarray(w) for w in arrays))


def train_chain(
    bodies: Bodies, before_m: Floats, kind: int, spec: ChainSpec, seed: int, progress: Progress
) -> ChainNet:
    """Train the network of one kind of limb. before_m: see estimates. Raises ModelError as train_coarse does."""
    tf = tensorflow(seed + kind)
    model = _network(tf)

    def loss(crops: Any, poses: Any, ways: Any, seen: Any, weights: Any) -> Any:
        out = model([crops, poses], training=True)
        move, log_spread = out[..., :3] * STEP_M, out[..., 3]
        error = tf.sqrt(tf.reduce_sum((move - ways) ** 2, -1) + 1e-6) / SPREAD_M
        likelihood = error / tf.exp(log_spread) + 3.0 * log_spread
        places = tf.reduce_mean(weights * (error + 0.2 * likelihood))
        found, true = (tf.nn.l2_normalize((seen + m)[:, 1:] - (seen + m)[:, :-1], axis=-1) for m in (move, ways))
        both = tf.minimum(weights[:, 1:], weights[:, :-1])
        turned = tf.sqrt(tf.reduce_sum((found - true) ** 2, -1) + 1e-6) / 0.1
        return places + spec.direction * tf.reduce_mean(both * turned)

    train(tf, model, loss, _batches(bodies, before_m, kind, spec, seed), LoopSpec(spec.steps), _NAMES[kind], progress)
    net = _runtime(model)
    crops, poses = draw(bodies, before_m, np.arange(1), kind, spec, np.random.default_rng(seed))[:2]
    wanted = np.asarray(model([crops, poses], training=False))[..., :3] * STEP_M
    difference = float(np.abs(limb_moves(net, crops, poses)[0] - wanted).max())
    if difference > 1e-4:
        raise ModelError(f"the {_NAMES[kind]}'s run time is off by {1000 * difference:.2f} mm from what was trained")
    return net
