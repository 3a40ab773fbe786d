"""What each choice is worth: the forest's training, scaled down, then the steps after it with the shipped model.

Training: one thing changed at a time from 3 trees, depth 20, all frames, offsets of +-0.45 m, mirror images; scored on
unseen people: pixels given their part, visible joints whose best proposal is within 10 cm, their median error; and for
one row with joints taken as surface modes of the part distribution (the published way before regression).
Run time: the shipped model, steps switched off by their configuration, on operators with free arms and free motion.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from benchmarks.training_data import forest_answer, rendered_images
from teleop.body.model import BodyModel, load_model
from teleop.body.parts import MIRROR_PART, N_PARTS
from teleop.body.tracker import BodyTracker
from teleop.config.body import BodyConfig
from teleop.config.intent import AngleConfig
from teleop.errors import DataError
from teleop.evaluation.angle_figures import angle_figure, angle_pairs
from teleop.evaluation.answers import run_tracker, single_frame
from teleop.evaluation.metrics import errors_m, figures_of, near_share
from teleop.evaluation.motions import FreeMotion
from teleop.evaluation.section import table
from teleop.evaluation.stills import Stills
from teleop.evaluation.store import FrameStore
from teleop.joints import N_JOINTS
from teleop.training.build import bone_lengths, join_trees
from teleop.training.fitting import best_errors_m, fit_model, propose_all, walk_frames
from teleop.training.images import Images, Pixels, draw_pixels
from teleop.training.leaves import Leaves, fill_leaves
from teleop.training.trainer import Tree, TreeSpec, grow_tree

_VALIDATION = 400
_PER_FRAME, _LEAF_PER_FRAME, _SLOTS, _BALANCE = 120, 200, 8, 0.5
_KEPT = Path("build/evaluation")

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Choice:
    """One row of the training table. share: of the frames."""

    trees: int = 3
    share: float = 1.0
    mirror: bool = True
    tree: TreeSpec = field(default_factory=lambda: TreeSpec(candidates=80))


BASE = Choice()
CHOICES: dict[str, Choice] = {
    "base": BASE,
    "1 tree": replace(BASE, trees=1),
    "2 trees": replace(BASE, trees=2),
    "6 trees": replace(BASE, trees=6),
    "depth 10": replace(BASE, tree=replace(BASE.tree, depth=10)),
    "depth 15": replace(BASE, tree=replace(BASE.tree, depth=15)),
    "a quarter of the frames": replace(BASE, share=0.25),
    "half of the frames": replace(BASE, share=0.5),
    "offsets of +-0.1 m": replace(BASE, tree=replace(BASE.tree, offset_m=0.1)),
    "offsets of +-0.2 m": replace(BASE, tree=replace(BASE.tree, offset_m=0.2)),
    "no mirror images": replace(BASE, mirror=False),
}


def first_frames(images: Images, count: int) -> Images:
    """Images of the first frames, sharing their pixels."""
    per_frame = ("starts", "widths", "heights", "u0", "v0", "cx", "cy", "focal_px", "joints_m", "visible")
    return replace(images, **{name: getattr(images, name)[:count] for name in per_frame})


def without_mirror(images: Images, pixels: Pixels) -> Pixels:
    """The same pixels, none of them as its mirror image."""
    flipped = pixels.frame >= len(images)
    back = np.array([*MIRROR_PART, *range(N_PARTS, 256)], np.uint8)
    frame = (pixels.frame % len(images)).astype(np.int32)
    return Pixels(pixels.at, frame, np.where(flipped, back[pixels.part], pixels.part).astype(np.uint8))


def grow(images: Images, choice: Choice) -> tuple[list[Tree], list[Leaves]]:
    """The trees of a choice; the same seeds for all."""
    images = first_frames(images, round(choice.share * len(images)))
    trees, contents = [], []
    for number in range(choice.trees):
        rng = np.random.default_rng([8, number])
        pixels = draw_pixels(images, _PER_FRAME, rng, _BALANCE)
        seed, filling = int(rng.integers(2**31)), draw_pixels(images, _LEAF_PER_FRAME, rng, 0.0)
        if not choice.mirror:
            pixels, filling = without_mirror(images, pixels), without_mirror(images, filling)
        tree = [t for _, t in grow_tree(images, pixels, choice.tree, seed) if t is not None][-1]
        trees.append(tree)
        contents.append(fill_leaves(images, filling, tree, _SLOTS))
    return trees, contents


def surface_votes(model: BodyModel) -> BodyModel:
    """The model whose pixels vote for nothing but their own place: each leaf for the joints of its likeliest parts,
    as surely as it gives them, pushed 39 mm back along z (the published mean)."""
    parts = model.leaf_parts[:, :N_JOINTS].astype(np.float64) / 255.0
    order = np.argsort(-parts, axis=1)[:, :_SLOTS].astype(np.uint8)
    share = np.take_along_axis(parts, order.astype(np.int64), axis=1)
    # a vote weighs (1 + (spread / 0.06 m)^2)^-2 and its spread is kept in steps of 2 mm
    spread = 0.06 * np.sqrt(np.maximum(1.0 / np.sqrt(np.maximum(share, 1e-4)) - 1.0, 0.0)) / 0.002
    offset = np.zeros((*order.shape, 3), np.int16)
    offset[..., 2] = 39
    return replace(
        model,
        vote_joint=np.where(share > 0.05, order, N_JOINTS).astype(np.uint8),
        vote_mm=offset,
        vote_spread=np.clip(spread, 0, 255).astype(np.uint8),
    )


def joint_score(model: BodyModel, images: Images) -> tuple[float, float]:
    """Share of visible joints whose best proposal is within 10 cm, median error [m], on the second half of images;
    bandwidths are fitted on the first half."""
    config, half = BodyConfig(), len(images) // 2
    model = fit_model(model, images, half, config)
    walked = walk_frames(model, images, len(images), config)[half:]
    error = best_errors_m(propose_all(model, walked, config), images.joints_m[half:])[images.visible[half:]]
    return float((error < 0.1).mean()), float(np.median(error))


def training_table(frames: int) -> str:
    """One row a choice."""
    train, test = rendered_images(frames, _VALIDATION)
    asked = draw_pixels(test, 100, np.random.default_rng(4), 0.0)
    asked = without_mirror(test, asked)
    rows = []
    for name, choice in CHOICES.items():
        trees, contents = grow(train, choice)
        right = float((forest_answer(test, asked, trees, contents) == asked.part).mean())
        model = join_trees(trees, contents, bone_lengths(train.joints_m), {})
        models = {name: model} | (
            {"base, surface modes instead of votes": surface_votes(model)} if name == "base" else {}
        )
        for row, one in models.items():
            near, median = joint_score(one, test)
            rows.append([row, f"{100 * right:.1f}", f"{100 * near:.1f}", f"{1000 * median:.0f}"])
            print("|", " | ".join(rows[-1]), "|", flush=True)
    return table(("training", "pixels right %", "proposals within 10 cm %", "median mm"), rows)


def switched() -> dict[str, BodyConfig]:
    """Configurations of the run-time table: everything, then one step off at a time."""
    base = BodyConfig()

    def off(section: str, **values: object) -> BodyConfig:
        return base.model_copy(update={section: getattr(base, section).model_copy(update=values)})

    return {
        "all steps": base,
        "no filter": single_frame(base),
        "no bone lengths in the forest's skeleton": off("skeleton", enabled=False),
        "depth steps alone part people from things": off("cascade", finder=False),
        "one look at the limbs": off("cascade", rounds=1),
        "no look at the limbs: the coarse network alone": off("cascade", rounds=0),
        "no networks after the forest": off("cascade", enabled=False),
    }


def run_time_table() -> str:
    """One row a switch; single frames of operators with free arms, and free motion in order."""
    model, store = load_model(), FrameStore(_KEPT, os.cpu_count() or 1)
    stills, motion = list(store.cases(Stills("free"), 10)), list(store.cases(FreeMotion(60), 4))
    rows = []
    for name, config in switched().items():
        free = run_tracker(BodyTracker(model, single_frame(config)), stills, single=True)
        moving = run_tracker(BodyTracker(model, config), motion, single=False)
        error = errors_m(free)
        elbows = [angle_figure(*angle_pairs(a, AngleConfig()).of("theta3")) for a in (free, moving)]
        rows.append(
            [name, f"{100 * near_share(figures_of(free)):.1f}", f"{1000 * np.nanmedian(error):.0f}",
             f"{elbows[0].mean:.1f}", f"{100 * near_share(figures_of(moving)):.1f}",
             f"{elbows[1].mean:.1f} / {elbows[1].p95:.1f}"]
        )  # fmt: skip
    head = (
        "run time",
        "stills: within 10 cm %",
        "median mm",
        "elbow mean deg",
        "motion: within 10 cm %",
        "elbow mean / p95",
    )
    return table(head, rows)


def main(frames: float = 2000) -> None:
    """Print both tables. frames: to train on."""
    try:
        print(run_time_table(), flush=True)
        print(training_table(int(frames)))
    except DataError as error:
        print(f"ablation: {error}")


if __name__ == "__main__":
    main()
