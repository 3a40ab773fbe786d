"""A small rendered training set for the benches of training, kept in build/ between runs."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt
from rich.console import Console
from rich.progress import Progress

from teleop.body.parts import N_PARTS
from teleop.parallel import open_pool
from teleop.software import library_digest
from teleop.training.dataset import Images, Pixels, load_images, render_dataset
from teleop.training.leaves import Leaves, tree_leaves
from teleop.training.recipe import PADDING_M
from teleop.training.trainer import Tree

_FOLDER = Path("build/bench-training")


def rendered_images(train: int, validation: int) -> tuple[Images, Images]:
    """Training and validation images, drawn as ``teleop train`` draws them. Raises DataError without the people."""
    with (
        open_pool(os.cpu_count(), None, library_digest) as pool,
        Progress(console=Console(file=sys.stderr), transient=True) as bars,
    ):
        for split, count in (("train", train), ("validation", validation)):
            task = bars.add_task(f"rendering {split}", total=1.0)
            for done, total in render_dataset(_FOLDER, split, count, PADDING_M, pool):  # type: ignore[arg-type]
                bars.update(task, completed=done / total)
    return load_images(_FOLDER, "train", train), load_images(_FOLDER, "validation", validation)


def forest_answer(images: Images, pixels: Pixels, trees: list[Tree], contents: list[Leaves]) -> npt.NDArray[np.int64]:
    """Likeliest part (N,) of each pixel by the averaged distribution of the trees (source eq. 2)."""
    total = np.zeros((len(pixels.at), N_PARTS))
    for tree, leaves in zip(trees, contents, strict=True):
        total += leaves.parts[tree_leaves(images, pixels, tree)]
    return total.argmax(axis=1)
