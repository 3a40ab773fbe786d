"""A small rendered training set for the benches of training, kept in build/ between runs."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
from rich.console import Console
from rich.progress import Progress

from teleop.body.model import load_model
from teleop.body.parts import N_PARTS
from teleop.config.body import BodyConfig
from teleop.parallel import open_pool
from teleop.software import library_digest
from teleop.training.bodies import load_bodies
from teleop.training.dataset import Split, render_dataset
from teleop.training.images import Images, Pixels, padded
from teleop.training.leaves import Leaves, tree_leaves
from teleop.training.recipe import PADDING_M
from teleop.training.trainer import Tree

_FOLDER = Path("build/bench-training")


def rendered_images(train: int, validation: int) -> tuple[Images, Images]:
    """Training and validation images, drawn as ``teleop train`` draws them and cut out by the shipped finder.

    Raises DataError without the people.
    """
    wanted: tuple[tuple[Split, int], ...] = (("train", train), ("validation", validation))
    with (
        open_pool(os.cpu_count(), None, library_digest) as pool,
        Progress(console=Console(file=sys.stderr), transient=True) as bars,
    ):
        for split, count in wanted:
            task = bars.add_task(f"rendering {split}", total=1.0)
            for done, total in render_dataset(_FOLDER, split, count, pool):
                bars.update(task, completed=done / total)
    finder, config = load_model().finder, BodyConfig()
    first, second = (padded(load_bodies(_FOLDER, split, count, finder, config), PADDING_M) for split, count in wanted)
    return first, second


def forest_answer(images: Images, pixels: Pixels, trees: list[Tree], contents: list[Leaves]) -> npt.NDArray[np.int64]:
    """Likeliest part (N,) of each pixel by the averaged distribution of the trees (source eq. 2)."""
    total = np.zeros((len(pixels.at), N_PARTS))
    for tree, leaves in zip(trees, contents, strict=True):
        total += leaves.parts[tree_leaves(images, pixels, tree)]
    return total.argmax(axis=1)
