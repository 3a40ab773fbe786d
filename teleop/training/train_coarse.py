"""Training the coarse network (teleop.body.coarse): a crop of the operator in, all joints out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from teleop.body.coarse import N_OUTPUTS, REACH_M, SPREAD_M, CoarseNet, anchor_places, places, to_crop, whole_crop
from teleop.body.crop import EMPTY, WHOLE, body_centre
from teleop.body.layers import F32
from teleop.joints import MIRROR_JOINT, N_JOINTS
from teleop.training.bodies import Bodies, thinned
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

_BLOCKS: Final = ((16, 5, 2), (32, 3, 2), (32, 3, 1), (64, 3, 2), (64, 3, 1), (64, 3, 1), (64, 3, 1), (64, 3, 1))
"""Outputs, kernel size and stride of each convolution."""
_RESIDUAL: Final = (5, 6, 7)


@dataclass(frozen=True, slots=True)
class CoarseSpec:
    """steps: batches of ``frames`` frames. shift_m: spread of the crop's centre across, down and in depth.
    hidden_weight: of joints that are not visible. dropout: share of the frames of which some pixels go.
    cut: share of which everything below some row goes."""

    steps: int = 20_000
    frames: int = 64
    shift_m: tuple[float, float, float] = (0.06, 0.08, 0.08)
    hidden_weight: float = 0.25
    dropout: float = 0.2
    cut: float = 0.06


def draw(bodies: Bodies, frames: npt.NDArray[np.int64], spec: CoarseSpec, rng: np.random.Generator) -> tuple[F32, ...]:
    """Crops (N, rows, columns, 2), places (N, J, 3) as teleop.body.coarse.to_crop gives them, weights (N, J).

    Half of the frames are mirrored.
    """
    crops = np.empty((len(frames), WHOLE.rows, WHOLE.columns, 2), np.float32)
    truth = np.empty((len(frames), N_JOINTS, 3), np.float32)
    weights = np.empty((len(frames), N_JOINTS), np.float32)
    for n, f in enumerate(frames):
        image = thinned(bodies.pixels(f), spec.dropout, rng)
        fx, fy, _, _ = image.intrinsics
        column, row, depth_m = np.array(body_centre(image)) + rng.normal(0, 1, 3) * [0.0, 0.0, spec.shift_m[2]]
        depth_m = max(depth_m, 0.5)
        column += rng.normal(0, spec.shift_m[0]) * fx / depth_m
        row += rng.normal(0, spec.shift_m[1]) * fy / depth_m
        mirror = bool(rng.uniform() < 0.5)
        crops[n] = whole_crop(image, (float(column), float(row), float(depth_m)), mirror)
        if rng.uniform() < spec.cut:
            lowest = int(np.flatnonzero(crops[n, ..., 1].any(axis=1))[-1:].sum())
            crops[n, int(rng.uniform(0.4, 1.0) * lowest) :] = (EMPTY, 0.0)
        place = to_crop(bodies.joints_m[f], (column, row, depth_m), image.intrinsics)
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


def network(torch: Any) -> Any:
    """The untrained network: crop (N, 2, rows, columns) to anchors (N, A, J, N_OUTPUTS)."""
    nn = torch.nn

    class Net(torch.nn.Module):  # type: ignore[misc]
        """Convolutions, then one head for every anchor."""

        def __init__(self) -> None:
            super().__init__()
            inputs, blocks = 2, []
            for outputs, size, stride in _BLOCKS:
                blocks.append(convolution(torch, inputs, outputs, size, stride))
                inputs = outputs
            self.blocks = nn.ModuleList(blocks)
            self.head = nn.Conv2d(inputs, N_JOINTS * N_OUTPUTS, 1)

        def forward(self, x: Any) -> Any:
            for n, block in enumerate(self.blocks):
                x = x + block(x) if n in _RESIDUAL else block(x)
            return self.head(x).permute(0, 2, 3, 1).flatten(1, 2).unflatten(2, (N_JOINTS, N_OUTPUTS))

    return Net()


def vote(torch: Any, out: Any) -> tuple[Any, Any]:
    """Places (N, J, 3) and log spreads (N, J) of the anchors' votes."""
    strides = int(np.prod([stride for _, _, stride in _BLOCKS]))
    anchors = torch.from_numpy(anchor_places(WHOLE.rows // strides, WHOLE.columns // strides))[:, None, :]
    weight = torch.softmax(out[..., 0], 1)[..., None]
    offsets = out[..., 1:4] * REACH_M
    there = torch.cat([offsets[..., :2] + anchors, offsets[..., 2:]], -1)
    return (weight * there).sum(1), (weight[..., 0] * out[..., 4]).sum(1)


def runtime(model: Any) -> CoarseNet:
    """The trained network in the form of the run time."""
    head, bias = dense(model.head)
    return CoarseNet(stacked(model.blocks, _RESIDUAL), head, bias)


def train_coarse(bodies: Bodies, spec: CoarseSpec, seed: int, progress: Progress) -> CoarseNet:
    """Train from frames and a seed. Raises ModelError when PyTorch is missing, when the training diverges or when the
    run time's answers are not those of the trained network."""
    torch = pytorch(seed)
    model = network(torch)

    def loss(crops: Any, truth: Any, weights: Any) -> Any:
        found, log_spread = vote(torch, model(channels_first(crops)).float())
        error = (((found - truth) ** 2).sum(-1) + 1e-5).sqrt() / SPREAD_M
        # the likelihood of an error whose density falls exponentially with its length teaches the spread
        likelihood = error / log_spread.exp() + 3.0 * log_spread
        return (weights * (error + 0.3 * likelihood)).mean()

    train(torch, model, loss, _batches(bodies, spec, seed), LoopSpec(spec.steps), "coarse network", progress)
    net = runtime(model)
    crops = draw(bodies, np.arange(1), spec, np.random.default_rng(seed))[0]
    with torch.no_grad():
        wanted = vote(torch, model(channels_first(torch.from_numpy(crops))))[0][0].numpy()
    check_runtime([places(net, crops[0])[0]], [wanted], 1e-4, "coarse network")
    return net
