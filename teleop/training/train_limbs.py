"""Training the limb networks (teleop.body.limbs) on what the stages before them leave."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from teleop.body.coarse import CoarseNet, locate
from teleop.body.crop import LOCAL
from teleop.body.features import Pixels
from teleop.body.layers import F32
from teleop.body.limbs import (
    GROUP_NAMES,
    GROUPS,
    LINKS,
    SPREAD_M,
    STEP_M,
    SWAPPED,
    LimbNet,
    Part,
    Round,
    before_sensor,
    limb_crops,
    place,
    pose_vectors,
    run_limbs,
)
from teleop.joints import N_JOINTS
from teleop.training.bodies import Bodies, Floats, thinned
from teleop.training.build import Progress
from teleop.training.network import (
    LoopSpec,
    channels_first,
    check_runtime,
    convolution,
    dense,
    pytorch,
    stacked,
    train,
)

_TURN: Final = np.array([-1.0, 1.0, 1.0])


@dataclass(frozen=True, slots=True)
class LimbSpec:
    """steps: batches of ``frames`` frames with all limbs of the group. shift_m: noise on each joint beside what the
    stages before leave. hidden_weight: of joints that are not visible. dropout: share of the frames of which some
    pixels go. direction: weight of the directions of the bones beside the places of the joints. channels, hidden:
    sizes of the network."""

    steps: int = 15_000
    frames: int = 40
    shift_m: float = 0.006
    hidden_weight: float = 0.2
    dropout: float = 0.2
    direction: float = 0.5
    channels: tuple[int, ...] = (16, 32, 48, 64)
    hidden: tuple[int, int] = (192, 128)


def _each(bodies: Bodies, work: Callable[[int], Floats], name: str, progress: Progress) -> Floats:
    out = np.empty((len(bodies), N_JOINTS, 3))
    with ThreadPoolExecutor() as pool:
        for f, joints in enumerate(pool.map(work, range(len(bodies)), chunksize=64)):
            out[f] = joints
            if f % 100 == 0 or f + 1 == len(bodies):
                progress(name, (f + 1) / len(bodies))
    return out


def coarse_joints(bodies: Bodies, coarse: CoarseNet, progress: Progress) -> Floats:
    """Joints (F, 20, 3) of the coarse network for every frame."""
    return _each(bodies, lambda f: locate(coarse, bodies.pixels(f))[0], "joints of the coarse network", progress)


def round_joints(bodies: Bodies, before_m: Floats, nets: Round, progress: Progress) -> Floats:
    """Joints (F, 20, 3) after one more round for every frame."""
    parts = tuple(Part(group) for group in range(len(nets)))
    return _each(bodies, lambda f: place(nets, bodies.pixels(f), before_m[f], parts)[0], "joints of a round", progress)


def draw(
    bodies: Bodies,
    before_m: Floats,
    frames: npt.NDArray[np.int64],
    group: int,
    spec: LimbSpec,
    rng: np.random.Generator,
) -> tuple[F32, ...]:
    """Crops (N LINKS, rows, columns, 2), poses (N, 3 N_JOINTS), ways back (N, LINKS, 3) in the orientation of the
    crops, the limb as it was seen (N, LINKS, 3) and weights (N, LINKS), with N the limbs of all frames.

    A trunk is mirrored every other time; arms and legs come from both sides.
    """
    joints_of = GROUPS[group]
    crops, poses, ways, seen, weights = [], [], [], [], []
    for f in frames:
        joints = before_sensor(before_m[f] + rng.normal(0, spec.shift_m * rng.uniform(0, 2), (N_JOINTS, 3)))
        image: Pixels = thinned(bodies.pixels(f), spec.dropout, rng)
        turned = len(joints_of) == 1 and bool(rng.uniform() < 0.5)
        crops.append(limb_crops(image.tuple(), joints, joints_of, turned, LOCAL.tuple()))
        poses.append(pose_vectors(joints, joints_of, turned, SWAPPED))
        way, limb = (bodies.joints_m[f] - joints)[joints_of], joints[joints_of]
        for side in range(len(joints_of)):
            if (side == 1) != turned:
                way[side], limb[side] = way[side] * _TURN, limb[side] * _TURN
        ways.append(way)
        seen.append(limb - limb[:, :1])
        weights.append(np.where(bodies.visible[f][joints_of], 1.0, spec.hidden_weight))
    columns = (crops, poses, ways, seen, weights)
    return tuple(np.concatenate(column).astype(np.float32) for column in columns)


def _batches(bodies: Bodies, before_m: Floats, group: int, spec: LimbSpec, seed: int) -> Iterator[tuple[F32, ...]]:
    rng = np.random.default_rng([seed, 3, group])
    while True:
        order = rng.permutation(len(bodies))
        for first in range(0, len(order) - spec.frames + 1, spec.frames):
            yield draw(bodies, before_m, order[first : first + spec.frames], group, spec, rng)


def network(torch: Any, spec: LimbSpec) -> Any:
    """The untrained network: crops (N LINKS, 2, rows, columns) and poses (N, 3 N_JOINTS) to (N, LINKS, 4)."""
    nn = torch.nn

    class Net(torch.nn.Module):  # type: ignore[misc]
        """The eyes look at each crop, the mind at all of a limb."""

        def __init__(self) -> None:
            super().__init__()
            inputs, eyes = 2, []
            for n, outputs in enumerate(spec.channels):
                eyes.append(convolution(torch, inputs, outputs, 3 if n else 5, 2))
                inputs = outputs
            self.eyes = nn.Sequential(*eyes)
            cells = (LOCAL.rows >> len(eyes)) * (LOCAL.columns >> len(eyes))
            h1, h2 = spec.hidden
            self.mind = nn.Sequential(
                nn.Linear(LINKS * inputs * cells + 3 * N_JOINTS, h1),
                nn.ReLU(),
                nn.Linear(h1, h2),
                nn.ReLU(),
                nn.Linear(h2, 4 * LINKS),
            )

        def forward(self, crops: Any, poses: Any) -> Any:
            seen = self.eyes(crops).permute(0, 2, 3, 1).reshape(len(poses), -1)
            return self.mind(torch.cat([seen, poses], 1)).unflatten(1, (LINKS, 4))

    return Net()


def runtime(model: Any) -> LimbNet:
    """The trained network in the form of the run time."""
    layers = [values for layer in (model.mind[0], model.mind[2], model.mind[4]) for values in dense(layer)]
    return LimbNet(stacked(model.eyes), *layers)


def train_limbs(
    bodies: Bodies, before_m: Floats, group: int, spec: LimbSpec, seed: int, name: str, progress: Progress
) -> LimbNet:
    """Train the network of one group. before_m: (F, 20, 3) joints of the stages before. Raises ModelError as
    train_coarse does."""
    torch = pytorch(seed + group)
    model = network(torch, spec)
    name = f"{name}, {GROUP_NAMES[group]}"

    def loss(crops: Any, poses: Any, ways: Any, seen: Any, weights: Any) -> Any:
        out = model(channels_first(crops), poses).float()
        move, log_spread = out[..., :3] * STEP_M, out[..., 3]
        error = (((move - ways) ** 2).sum(-1) + 1e-6).sqrt() / SPREAD_M
        likelihood = error / log_spread.exp() + 3.0 * log_spread
        places = (weights * (error + 0.2 * likelihood)).mean()
        unit = torch.nn.functional.normalize
        found, true = (unit((seen + m)[:, 1:] - (seen + m)[:, :-1], dim=-1) for m in (move, ways))
        both = torch.minimum(weights[:, 1:], weights[:, :-1])
        turned = (((found - true) ** 2).sum(-1) + 1e-6).sqrt() / 0.1
        return places + spec.direction * (both * turned).mean()

    train(torch, model, loss, _batches(bodies, before_m, group, spec, seed), LoopSpec(spec.steps), name, progress)
    net = runtime(model)
    crops, poses = draw(bodies, before_m, np.arange(1), group, spec, np.random.default_rng(seed))[:2]
    with torch.no_grad():
        wanted = model(channels_first(torch.from_numpy(crops)), torch.from_numpy(poses)).flatten(1).numpy()
    found = run_limbs(crops, poses, net.tuple())
    check_runtime([found], [wanted], 1e-3, f"network of the {name}")
    return net
