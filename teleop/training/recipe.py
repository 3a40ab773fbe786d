"""The one recipe of the shipped model: render, grow, fit, save, and the model card beside it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from teleop.body.model import BodyModel, save_model
from teleop.config.body import BodyConfig
from teleop.errors import ModelError
from teleop.parallel import open_pool
from teleop.people.sampling import RenderedFrame, SampleSpec, sample_frame
from teleop.software import library_digest
from teleop.training.build import BuildSpec, Progress, build_model
from teleop.training.correcting import fit_correction
from teleop.training.dataset import HEIGHT, WIDTH, Images, Split, load_images, render_dataset
from teleop.training.fitting import best_errors_m, fit_model, fit_person, propose_all, walk_frames

MAX_BYTES: Final = 20_000_000
PADDING_M: Final = 0.5
"""Training images are padded for feature offsets up to this."""


@dataclass(frozen=True, slots=True)
class Recipe:
    """frames: training frames. validation: frames the fit uses; as many again are scored. correction: further
    validation frames for the joint correction. rooms: frames with a room, and as many without, that teach what is a
    person. seed: of all draws. workers: processes that render, by default one per core. scheduler: address of a Dask
    cluster that renders instead."""

    frames: int = 24000
    validation: int = 300
    correction: int = 2400
    rooms: int = 400
    seed: int = 2011
    workers: int | None = None
    scheduler: str | None = None
    build: BuildSpec = field(default_factory=BuildSpec)


def person_frames(count: int) -> Iterator[RenderedFrame]:
    """People of the training split in rooms, then as many without a room; seeds far from those of the trees."""
    for first, room in ((10_000_000, True), (11_000_000, False)):
        for n in range(count):
            spec = SampleSpec(split="train", width=WIDTH, height=HEIGHT, room=room, mirrored=bool(n % 2))
            yield sample_frame(first + n, spec)


def train_model(recipe: Recipe, work: Path, output: Path, progress: Progress) -> BodyModel:
    """Make a model and its card. work: folder of the rendered frames, kept, so that a second run goes on from it.

    Raises ModelError when the file would be larger than 20 MB, DataError when the people's data set is missing.
    """
    validation = 2 * recipe.validation + recipe.correction
    wanted: tuple[tuple[Split, int], ...] = (("validation", validation), ("train", recipe.frames))
    with open_pool(recipe.workers, recipe.scheduler, library_digest) as pool:
        for split, count in wanted:
            for done, total in render_dataset(work, split, count, PADDING_M, pool):
                progress(f"rendering {split}", done / total)
    model = build_model(load_images(work, "train", recipe.frames), recipe.build, recipe.seed, progress)
    progress("fitting", 0.0)
    model = fit_everything(model, recipe, work)
    output.parent.mkdir(parents=True, exist_ok=True)
    save_model(model, output)
    progress("fitting", 1.0)
    if output.stat().st_size > MAX_BYTES:
        raise ModelError(f"'{output}' is larger than 20 MB; use fewer trees or a larger smallest leaf")
    output.with_name("CARD.md").write_text(card(model, recipe, output))
    return model


def fit_everything(model: BodyModel, recipe: Recipe, work: Path) -> BodyModel:
    """What is fitted after the trees, from the validation frames in ``work``, and the figures."""
    scored = 2 * recipe.validation
    validation = scored + recipe.correction
    images = load_images(work, "validation", validation)
    config = BodyConfig()
    model = fit_model(model, images, recipe.validation, config)
    fitting = images.joints_m[scored:]
    proposals = propose_all(model, walk_frames(model, images, len(images), config)[scored:], config)
    model = fit_correction(model, proposals, fitting, config)
    model = fit_person(model, person_frames(recipe.rooms), config)
    stamp = datetime.now(UTC).strftime("%Y-%m-%d")
    figures = _figures(model, images, recipe.validation, scored, config)
    return replace(model, meta={**model.meta, "date": stamp, **figures})


def _figures(model: BodyModel, images: Images, first: int, last: int, config: BodyConfig) -> dict[str, float]:
    """Raw single-frame figures on the validation frames that the fit did not use."""
    walked = walk_frames(model, images, last, config)[first:]
    error = best_errors_m(propose_all(model, walked, config), images.joints_m[first:last])[images.visible[first:last]]
    return {
        "joints_within_10cm": round(float((error < 0.1).mean()), 4),
        "median_error_m": round(float(sorted(error)[len(error) // 2]), 4),
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
            "correction",
            f"linear in the vectors to neighbour joints, on {recipe.correction} further validation frames",
        ),
        ("person or not", f"logistic regression, {2 * recipe.rooms} training frames, half of them in furnished rooms"),
    )
    near, median_mm = 100 * model.meta["joints_within_10cm"], 1000 * model.meta["median_error_m"]
    return "\n".join(
        (
            "# Body model",
            "",
            "| | |",
            "|---|---|",
            *(f"| {name} | {value} |" for name, value in rows),
            "",
            "On other validation frames (people, clothes, motions not in training), single-frame proposals of visible",
            f"joints: {near:.1f} % within 10 cm, median error {median_mm:.0f} mm. `teleop evaluate` prints all.",
            "",
            "The model knows one standing person seen from the front, turned by up to 45 degrees, 1.2-4 m away, from a",
            "sensor 0.6-2 m high and tilted by up to 15 degrees. Seated, lying and turned people are outside of that.",
            "",
        )
    )
