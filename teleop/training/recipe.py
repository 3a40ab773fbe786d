"""The one recipe of the shipped model: render, train, grow, fit, save, and the model card beside it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np

from teleop.body.cascade import N_CUES, Cascade
from teleop.body.finder import Finder
from teleop.body.limbs import GROUP_NAMES, Round
from teleop.body.model import BodyModel, model_arrays, model_of, save_model
from teleop.body.network_file import (
    coarse_arrays,
    coarse_of,
    crop_note,
    finder_arrays,
    finder_of,
    limb_arrays,
    limb_of,
)
from teleop.config.body import BodyConfig
from teleop.errors import ModelError
from teleop.parallel import open_pool
from teleop.software import library_digest
from teleop.training.bodies import Bodies, bodies_arrays, bodies_of, load_bodies
from teleop.training.build import BuildSpec, Progress, build_model
from teleop.training.dataset import CHUNK, Frames, Split, read_chunk, render_dataset
from teleop.training.fitting import best_errors_m, fit_model, fit_person, propose_all, walk_frames
from teleop.training.images import Images, padded
from teleop.training.network import pytorch
from teleop.training.stages import Stages
from teleop.training.train_coarse import CoarseSpec, train_coarse
from teleop.training.train_finder import FinderSpec, load_grids, train_finder
from teleop.training.train_limbs import LimbSpec, coarse_joints, round_joints, train_limbs
from teleop.training.trusting import fit_trust, placed_errors_m

MAX_BYTES: Final = 20_000_000
PADDING_M: Final = 0.5
"""Training images are padded for feature offsets up to this."""


@dataclass(frozen=True, slots=True)
class Recipe:
    """frames: training frames of the networks that place joints; both finders see the first finder_frames of them, the
    forest is grown from the first forest_frames. cutter: the finder that cuts training's operators out of scenes, soon
    trained and as faulty as segmentation is; finder: the one of the tracker. validation: frames the fit uses; as many
    again are scored, further trust ones teach the confidence and, as raw frames, what is a person. seed: of all draws.
    workers: processes that render, by default one per core. scheduler: address of a Dask cluster that renders instead.
    rounds: looks at the limbs, of the first groups each; a second one at legs and trunk is worth half a millimetre."""

    frames: int = 160_000
    finder_frames: int = 80_000
    forest_frames: int = 24_000
    validation: int = 400
    trust: int = 3200
    seed: int = 2011
    workers: int | None = None
    scheduler: str | None = None
    build: BuildSpec = field(default_factory=BuildSpec)
    cutter: FinderSpec = field(default_factory=lambda: FinderSpec(steps=6000))
    finder: FinderSpec = field(default_factory=FinderSpec)
    coarse: CoarseSpec = field(default_factory=CoarseSpec)
    rounds: tuple[tuple[LimbSpec, ...], ...] = (
        (LimbSpec(), LimbSpec(steps=7_000), LimbSpec(steps=6_000)),
        (LimbSpec(steps=100_000, direction=1.5),),
    )

    @property
    def validation_frames(self) -> int:
        """Validation frames in all."""
        return 2 * self.validation + self.trust


def shortened(recipe: Recipe, share: float) -> Recipe:
    """The recipe with this share of the networks' training steps."""

    def fewer(steps: int) -> int:
        return max(10, round(steps * share))

    return replace(
        recipe,
        cutter=replace(recipe.cutter, steps=fewer(recipe.cutter.steps)),
        finder=replace(recipe.finder, steps=fewer(recipe.finder.steps)),
        coarse=replace(recipe.coarse, steps=fewer(recipe.coarse.steps)),
        rounds=tuple(tuple(replace(spec, steps=fewer(spec.steps)) for spec in specs) for specs in recipe.rounds),
    )


def train_model(recipe: Recipe, work: Path, output: Path, progress: Progress) -> BodyModel:
    """Make a model and its card. work: folder of the rendered frames and of what is trained stage by stage, kept, so
    that a second run goes on from it.

    Raises ModelError when the file would be larger than 20 MB or PyTorch is missing, DataError when the people's data
    set is missing.
    """
    pytorch(recipe.seed)  # told before hours of rendering
    wanted: tuple[tuple[Split, int], ...] = (("validation", recipe.validation_frames), ("train", recipe.frames))
    with open_pool(recipe.workers, recipe.scheduler, library_digest) as pool:
        for split, count in wanted:
            for done, total in render_dataset(work, split, count, pool):
                progress(f"rendering {split}", done / total)
    config, stages = BodyConfig(), Stages(work)
    model = train_stages(recipe, work, stages, config, progress)
    progress("fitting", 0.0)
    model = fit_everything(model, recipe, work, config)
    output.parent.mkdir(parents=True, exist_ok=True)
    save_model(model, output)
    progress("fitting", 1.0)
    if output.stat().st_size > MAX_BYTES:
        raise ModelError(f"'{output}' is larger than 20 MB; use fewer trees or a larger smallest leaf")
    output.with_name("CARD.md").write_text(card(model, recipe, output))
    return model


def train_stages(recipe: Recipe, work: Path, stages: Stages, config: BodyConfig, progress: Progress) -> BodyModel:
    """Finder, forest and all networks that place joints; what is fitted on validation frames is still to come."""
    seed = recipe.seed

    def seeing(spec: FinderSpec) -> Finder:
        grids = load_grids(work, "train", min(recipe.finder_frames, recipe.frames), recipe.workers)
        return train_finder(grids, spec, seed, progress)

    settings = (recipe.cutter, recipe.finder_frames, recipe.frames, seed)
    cutter = stages.kept("cutter", settings, lambda: seeing(recipe.cutter), finder_arrays, finder_of)
    bodies = stages.kept(
        "operators",
        (config.segmentation, config.floor, recipe.forest_frames),
        lambda: load_bodies(work, "train", recipe.frames, cutter, config, recipe.workers, recipe.forest_frames),
        bodies_arrays,
        bodies_of,
    )
    progress("operators cut out", 1.0)
    forest = stages.kept(
        "forest",
        (recipe.build, recipe.forest_frames),
        lambda: build_model(padded(bodies.labelled(), PADDING_M), recipe.build, seed, progress),
        model_arrays,
        model_of,
    )
    coarse = stages.kept(
        "coarse", recipe.coarse, lambda: train_coarse(bodies, recipe.coarse, seed, progress), coarse_arrays, coarse_of
    )
    joints_m, rounds = coarse_joints(bodies, coarse, progress), list[Round]()
    for number, specs in enumerate(recipe.rounds):
        if rounds:
            joints_m = round_joints(bodies, joints_m, rounds[-1], progress)
        nets = (
            stages.kept(
                f"round_{number}_{GROUP_NAMES[group]}",
                specs[group],
                partial(
                    train_limbs,
                    bodies,
                    joints_m,
                    group,
                    specs[group],
                    seed + 10 * number,
                    f"round {number + 1}",
                    progress,
                ),
                partial(limb_arrays, "limb"),
                partial(limb_of, "limb"),
            )
            for group in range(len(specs))
        )
        rounds.append(tuple(nets))
    finder = stages.kept("finder", recipe.finder, lambda: seeing(recipe.finder), finder_arrays, finder_of)
    return replace(forest, finder=finder, cascade=Cascade(coarse, tuple(rounds), np.zeros(N_CUES + 1)))


def validation_chunks(recipe: Recipe, work: Path) -> Iterator[Frames]:
    """The raw validation frames that are neither fitted on nor scored."""
    first = -(-2 * recipe.validation // CHUNK) * CHUNK
    for at in range(first, recipe.validation_frames, CHUNK):
        yield read_chunk(work, "validation", at)


def fit_everything(model: BodyModel, recipe: Recipe, work: Path, config: BodyConfig) -> BodyModel:
    """What is fitted after training, from the validation frames in ``work``, and the figures."""
    bodies = load_bodies(work, "validation", recipe.validation_frames, model.finder, config, recipe.workers)
    images, scored = padded(bodies, PADDING_M), 2 * recipe.validation
    model = fit_model(model, images, recipe.validation, config)
    model = fit_trust(model, bodies, images, range(scored, len(bodies)), config)
    model = fit_person(model, validation_chunks(recipe, work), config)
    stamp = datetime.now(UTC).strftime("%Y-%m-%d")
    figures = _figures(model, bodies, images, range(recipe.validation, scored), config)
    return replace(model, meta={**model.meta, "date": stamp, **figures})


def _figures(model: BodyModel, bodies: Bodies, images: Images, frames: range, config: BodyConfig) -> dict[str, float]:
    """Single-frame figures on the validation frames that the fit did not use: the forest alone, and the whole."""
    walked = walk_frames(model, images, frames.stop, config)[frames.start :]
    truth, visible = images.joints_m[frames.start : frames.stop], images.visible[frames.start : frames.stop]
    forest = best_errors_m(propose_all(model, walked, config), truth)
    placed = placed_errors_m(model, bodies, images, frames, config)
    return {
        "forest_within_10cm": round(float((forest[visible] < 0.1).mean()), 4),
        "forest_median_error_m": round(float(np.median(forest[visible])), 4),
        "joints_within_10cm": round(float((placed[visible] < 0.1).mean()), 4),
        "median_error_m": round(float(np.median(placed[visible])), 4),
    }


def card(model: BodyModel, recipe: Recipe, output: Path) -> str:
    """The model card, Markdown."""
    b, t = recipe.build, recipe.build.tree
    size = f"{output.stat().st_size / 1e6:.1f} MB"
    command = (
        f"teleop train --frames {recipe.frames} --seed {recipe.seed} --trees {b.trees} --candidates {t.candidates}"
    )
    f, c, limbs = recipe.finder, recipe.coarse, recipe.rounds
    looks = "; ".join(
        ", ".join(f"{name} {spec.steps}" for name, spec in zip(GROUP_NAMES, specs, strict=False)) for specs in limbs
    )
    rows = (
        ("made by", f"`{command}`"),
        ("date", model.meta["date"]),
        ("size", f"{size}, {len(model.leaf_parts)} leaves in {b.trees} trees, deepest {model.max_depth}"),
        (
            "data",
            f"{recipe.frames} rendered frames, 320x240, and their mirror images: half of them people cut out, with "
            "faults of a segmentation, four in ten whole scenes with things and other people, one in ten without "
            "anybody; bodies from MakeHuman (CC0), poses random, from the CMU motion capture database or from Kinect "
            "skeletons; noise of a Kinect v1 and of other sensors",
        ),
        ("finder", f"{recipe.finder_frames} frames, {f.steps} steps of {f.frames}"),
        (
            "trees",
            f"{recipe.forest_frames} frames, {b.pixels} pixels a frame, {t.candidates} candidate features a node, "
            f"depth <= {t.depth}, >= {t.min_leaf} pixels a leaf",
        ),
        (
            "leaves",
            f"part distribution and offsets to the {b.slots} most certain joints, from {b.leaf_pixels} pixels a frame",
        ),
        ("fitted", f"bandwidth and reference weight per joint, on {recipe.validation} validation frames"),
        (
            "networks of joints",
            f"{crop_note()}; coarse: {c.steps} steps of {c.frames} frames; steps of the rounds: {looks}, of "
            f"{limbs[0][0].frames} frames",
        ),
        ("confidence, person or not", f"logistic regressions on {recipe.trust} further validation frames"),
    )
    m = model.meta
    return "\n".join(
        (
            "# Body model",
            "",
            "| | |",
            "|---|---|",
            *(f"| {name} | {value} |" for name, value in rows),
            "",
            "On other validation frames (people, clothes, motions not in training), visible joints in single frames:",
            "",
            "| | within 10 cm | median error |",
            "|---|---|---|",
            f"| forest and mean shift | {100 * m['forest_within_10cm']:.1f} % | "
            f"{1000 * m['forest_median_error_m']:.0f} mm |",
            f"| with the networks | {100 * m['joints_within_10cm']:.1f} % | {1000 * m['median_error_m']:.0f} mm |",
            "",
            "`teleop evaluate` prints all.",
            "",
            "The model knows one standing person seen from the front, turned by up to 45 degrees, 1.2-4 m away, from a",
            "sensor 0.6-2 m high and tilted by up to 15 degrees. Seated, lying and turned people are outside of that.",
            "",
        )
    )
