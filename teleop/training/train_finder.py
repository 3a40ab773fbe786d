"""Training the finder (teleop.body.finder): a decimated depth image in, the cells that show people out."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from teleop.body.finder import BLOCK, Finder, finder_input, person_cells
from teleop.body.layers import F32
from teleop.body.parts import NO_PART
from teleop.errors import DataError
from teleop.training.build import Progress
from teleop.training.dataset import CHUNK, Split, read_chunk
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

STEP: Final = 2
"""Of the grid in training images: 160 columns, as SegmentationConfig.grid_columns."""
_WIDTHS: Final = (12, 24, 40, 16)
"""Channels at a half, a quarter and an eighth of the grid, and on the way back."""


@dataclass(frozen=True, slots=True)
class FinderSpec:
    """steps: batches of ``frames`` frames. person_weight: of a person's cells beside the others'."""

    steps: int = 20_000
    frames: int = 32
    person_weight: float = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class Grids:
    """F decimated frames: depth_mm (F, h, w) uint16, person (F, h, w) bool."""

    depth_mm: npt.NDArray[np.uint16]
    person: npt.NDArray[np.bool_]


def _chunk(folder: Path, split: Split, first: int) -> Grids:
    frames = read_chunk(folder, split, first)
    thin = np.s_[:, ::STEP, ::STEP]
    person = (frames.part != NO_PART) | frames.others
    return Grids(frames.depth_mm[thin].copy(), person[thin].copy())


def load_grids(folder: Path, split: Split, frames: int, workers: int | None = None) -> Grids:
    """Rendered frames (rounded up to whole chunks), decimated. Raises DataError when a chunk is missing."""
    firsts = range(0, frames, CHUNK)
    out: Grids | None = None
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        for n, chunk in enumerate(pool.map(partial(_chunk, folder, split), firsts)):
            if out is None:
                size = (len(firsts) * CHUNK, *chunk.depth_mm.shape[1:])
                out = Grids(np.empty(size, np.uint16), np.empty(size, np.bool_))
            at = slice(n * CHUNK, n * CHUNK + len(chunk.depth_mm))
            out.depth_mm[at], out.person[at] = chunk.depth_mm, chunk.person
    if out is None:
        raise DataError("no training frames asked for; at least one is needed")
    return out


def draw(grids: Grids, frames: npt.NDArray[np.int64], rng: np.random.Generator) -> tuple[F32, F32]:
    """Inputs (N, h, w, 2) and who is there (N, h, w); half of the calls mirrored, some with pixels lost."""
    depth, person = grids.depth_mm[frames], grids.person[frames].astype(np.float32)
    if rng.uniform() < 0.5:
        depth, person = np.ascontiguousarray(depth[:, :, ::-1]), np.ascontiguousarray(person[:, :, ::-1])
    if rng.uniform() < 0.25:
        depth = np.where(rng.random(depth.shape, np.float32) < rng.uniform(0.0, 0.4), np.uint16(0), depth)
    seen = np.concatenate([finder_input(image, *image.shape) for image in depth])
    return seen, person


def _batches(grids: Grids, spec: FinderSpec, seed: int) -> Iterator[tuple[F32, ...]]:
    rng = np.random.default_rng([seed, 4])
    while True:
        order = rng.permutation(len(grids.depth_mm))
        for first in range(0, len(order) - spec.frames + 1, spec.frames):
            yield draw(grids, np.sort(order[first : first + spec.frames]), rng)


def network(torch: Any) -> Any:
    """The untrained network: (N, 2, h, w) to logits (N, h, w)."""
    nn, functional = torch.nn, torch.nn.functional
    c1, c2, c3, c4 = _WIDTHS

    class Net(torch.nn.Module):  # type: ignore[misc]
        """Down to an eighth of the grid and back to a quarter, whose cells answer for BLOCK x BLOCK."""

        def __init__(self) -> None:
            super().__init__()
            self.coming = nn.ModuleList([convolution(torch, 2, c1, 5, 2), convolution(torch, c1, c2, 3, 2)])
            deep = [convolution(torch, c2, c3, 3, 2)] + [convolution(torch, c3, c3, 3, 1) for _ in range(3)]
            self.deep = nn.ModuleList(deep)
            self.up, self.side = nn.Conv2d(c3, c4, 1), nn.Conv2d(c2, c4, 1)
            self.last = convolution(torch, c4, c4, 3, 1)
            self.head = nn.Conv2d(c4, BLOCK * BLOCK, 1)

        def forward(self, x: Any) -> Any:
            for block in self.coming:
                x = block(x)
            y = self.deep[0](x)
            for block in self.deep[1:]:
                y = y + block(y)
            z = torch.relu(self.side(x) + functional.interpolate(self.up(y), scale_factor=2, mode="nearest"))
            return functional.pixel_shuffle(self.head(z + self.last(z)), BLOCK)[:, 0]

    return Net()


def runtime(model: Any) -> Finder:
    """The trained network in the form of the run time."""
    (up, up_bias), (side, side_bias), (head, head_bias) = (dense(part) for part in (model.up, model.side, model.head))
    return Finder(
        coming=stacked(model.coming),
        deep=stacked(model.deep, range(1, len(model.deep))),
        up=up,
        side=side,
        bias=up_bias + side_bias,
        last=stacked([model.last], [0]),
        head=head,
        head_bias=head_bias,
    )


def train_finder(grids: Grids, spec: FinderSpec, seed: int, progress: Progress) -> Finder:
    """Train from frames and a seed. Raises ModelError when PyTorch is missing, when the training diverges or when the
    run time's answers are not those of the trained network."""
    torch = pytorch(seed)
    model = network(torch)

    def loss(seen: Any, person: Any) -> Any:
        logits = model(channels_first(seen)).float()
        weight = seen[..., 1] * (1.0 + (spec.person_weight - 1.0) * person)
        each = torch.nn.functional.binary_cross_entropy_with_logits(logits, person, reduction="none")
        return (each * weight).sum() / weight.sum()

    train(torch, model, loss, _batches(grids, spec, seed), LoopSpec(spec.steps), "finder", progress)
    finder = runtime(model)
    grid = grids.depth_mm[0]
    with torch.no_grad():
        wanted = torch.sigmoid(model(channels_first(torch.from_numpy(finder_input(grid, *grid.shape)))))[0].numpy()
    check_runtime([person_cells(finder, grid)], [wanted], 1e-3, "finder")
    return finder
