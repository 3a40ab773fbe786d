"""The one recipe of the shipped model: render, grow, fit, save, and the model card beside it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.body.cascade import N_CUES, Cascade
from teleop.body.model import BodyModel, save_model
from teleop.body.network_file import crop_note
from teleop.body.parts import NO_PART
from teleop.config.body import BodyConfig
from teleop.errors import ModelError
from teleop.evaluation.nobody import PER_BATCH, Nobody
from teleop.frames import DepthFrame
from teleop.parallel import open_pool
from teleop.people.sampling import SampleSpec, sample_frame
from teleop.software import library_digest
from teleop.training.bodies import load_bodies
from teleop.training.build import BuildSpec, Progress, build_model
from teleop.training.chaining import ChainSpec, estimates, train_chain
from teleop.training.dataset import HEIGHT, WIDTH, Images, Split, load_images, render_dataset
from teleop.training.fitting import best_errors_m, fit_model, fit_person, propose_all, walk_frames
from teleop.training.locating import CoarseSpec, train_coarse
from teleop.training.network import tensorflow
from teleop.training.refining import RefinerSpec, train_refiner
from teleop.training.trusting import fit_trust, placed_errors_m

MAX_BYTES: Final = 20_000_000
PADDING_M: Final = 0.5
"""Training images are padded for feature offsets up to this."""


@dataclass(frozen=True, slots=True)
class Recipe:
    """frames: training frames of the forest. validation: frames the fit uses; as many again are scored. trust: further
    validation frames for the confidence. rooms: frames with a room, and as many without, that teach what is a person.
    network_frames: training frames of the networks, the forest's first. seed: of all draws. workers: processes that
    render, by default one per core. scheduler: address of a Dask cluster that renders instead."""

    frames: int = 24000
    validation: int = 300
    trust: int = 2400
    network_frames: int = 100_000
    rooms: int = 400
    seed: int = 2011
    workers: int | None = None
    scheduler: str | None = None
    build: BuildSpec = field(default_factory=BuildSpec)
    coarse: CoarseSpec = field(default_factory=CoarseSpec)
    refiner: RefinerSpec = field(default_factory=RefinerSpec)
    limbs: tuple[ChainSpec, ChainSpec] = (ChainSpec(), ChainSpec(steps=6000))


def person_frames(count: int) -> Iterator[tuple[DepthFrame, npt.NDArray[np.uint8]]]:
    """Frames and part labels: people of the training split in rooms, as many without a room, as many rooms with
    things and no person; seeds far from those of the trees."""
    for first, room in ((10_000_000, True), (11_000_000, False)):
        for n in range(count):
            spec = SampleSpec(split="train", width=WIDTH, height=HEIGHT, room=room, mirrored=bool(n % 2))
            shot = sample_frame(first + n, spec)
            yield shot.frame, shot.part
    nobody = Nobody(WIDTH, HEIGHT, seed=71)
    for batch in range(-(-count // PER_BATCH)):
        for case in nobody.batch(batch):
            yield case.frame, np.full(case.frame.depth_mm.shape, NO_PART, np.uint8)


def train_model(recipe: Recipe, work: Path, output: Path, progress: Progress) -> BodyModel:
    """Make a model and its card. work: folder of the rendered frames, kept, so that a second run goes on from it.

    Raises ModelError when the file would be larger than 20 MB or TensorFlow is missing, DataError when the people's
    data set is missing.
    """
    tensorflow(recipe.seed)  # told before hours of rendering
    validation, frames = 2 * recipe.validation + recipe.trust, max(recipe.frames, recipe.network_frames)
    wanted: tuple[tuple[Split, int], ...] = (("validation", validation), ("train", frames))
    with open_pool(recipe.workers, recipe.scheduler, library_digest) as pool:
        for split, count in wanted:
            for done, total in render_dataset(work, split, count, PADDING_M, pool):
                progress(f"rendering {split}", done / total)
    model = build_model(load_images(work, "train", recipe.frames), recipe.build, recipe.seed, progress)
    model = replace(model, cascade=train_cascade(recipe, work, progress))
    progress("fitting", 0.0)
    model = fit_everything(model, recipe, work)
    output.parent.mkdir(parents=True, exist_ok=True)
    save_model(model, output)
    progress("fitting", 1.0)
    if output.stat().st_size > MAX_BYTES:
        raise ModelError(f"'{output}' is larger than 20 MB; use fewer trees or a larger smallest leaf")
    output.with_name("CARD.md").write_text(card(model, recipe, output))
    return model


def train_cascade(recipe: Recipe, work: Path, progress: Progress) -> Cascade:
    """All networks, from the frames in ``work``; the trust is still to be fitted."""
    bodies = load_bodies(work, "train", recipe.network_frames, recipe.workers)
    coarse = train_coarse(bodies, recipe.coarse, recipe.seed, progress)
    refiner = train_refiner(bodies, recipe.refiner, recipe.seed, progress)
    before_m = estimates(bodies, coarse, refiner, progress)
    arms, legs = (train_chain(bodies, before_m, kind, recipe.limbs[kind], recipe.seed, progress) for kind in (0, 1))
    return Cascade(coarse, refiner, (arms, legs), np.zeros(N_CUES + 1))


def fit_everything(model: BodyModel, recipe: Recipe, work: Path) -> BodyModel:
    """What is fitted after the trees, from the validation frames in ``work``, and the figures."""
    scored = 2 * recipe.validation
    images = load_images(work, "validation", scored + recipe.trust)
    config = BodyConfig()
    model = fit_model(model, images, recipe.validation, config)
    model = fit_trust(model, images, scored, len(images), config)
    model = fit_person(model, person_frames(recipe.rooms), config)
    stamp = datetime.now(UTC).strftime("%Y-%m-%d")
    figures = _figures(model, images, recipe.validation, scored, config)
    return replace(model, meta={**model.meta, "date": stamp, **figures})


def _figures(model: BodyModel, images: Images, first: int, last: int, config: BodyConfig) -> dict[str, float]:
    """Single-frame figures on the validation frames that the fit did not use: the forest alone, and the whole."""
    walked = walk_frames(model, images, last, config)[first:]
    forest = best_errors_m(propose_all(model, walked, config), images.joints_m[first:last])
    placed = placed_errors_m(model, images, first, last, config)
    visible = images.visible[first:last]
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
    rows = (
        ("made by", f"`{command}`"),
        ("date", model.meta["date"]),
        ("size", f"{size}, {len(model.leaf_parts)} leaves in {b.trees} trees, deepest {model.max_depth}"),
        (
            "data",
            f"{recipe.frames} rendered frames, 320x240, foreground with segmentation faults, and their mirror images; "
            "bodies from MakeHuman (CC0), poses random or from the CMU motion capture database; Kinect v1 noise",
        ),
        (
            "trees",
            f"{b.pixels} pixels a frame, {t.candidates} candidate features a node, depth <= {t.depth}, "
            f">= {t.min_leaf} pixels a leaf",
        ),
        (
            "leaves",
            f"part distribution and offsets to the {b.slots} most certain joints, from {b.leaf_pixels} pixels a frame",
        ),
        ("fitted", f"bandwidth and reference weight per joint, on {recipe.validation} validation frames"),
        (
            "networks",
            f"{crop_note()}; {recipe.network_frames} of the same kind of frames and their mirror images; coarse: "
            f"{recipe.coarse.steps} steps of {recipe.coarse.frames} frames, refiner: {recipe.refiner.steps} steps of "
            f"{recipe.refiner.frames * recipe.refiner.joints} joints, arms and legs: {recipe.limbs[0].steps} and "
            f"{recipe.limbs[1].steps} steps of {2 * recipe.limbs[0].frames} limbs on what the stages before leave",
        ),
        ("confidence", f"logistic regression on {recipe.trust} further validation frames"),
        (
            "person or not",
            f"logistic regression, {3 * recipe.rooms} training frames: rooms with people, people, rooms without",
        ),
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
