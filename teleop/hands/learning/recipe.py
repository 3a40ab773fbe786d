"""The hand model from seeds, in one go: render, train three networks, calibrate, write the file and its card."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from teleop.config.intent import HandConfig
from teleop.errors import DataError
from teleop.hands.learning import photos
from teleop.hands.learning.convnet import Schedule, calibrated, initial, train
from teleop.hands.learning.samples import Samples, augmenter, collect, openness
from teleop.hands.network import LAYERS_OF, Network, Sight, save_networks
from teleop.people.hand_shots import HandShot, hand_shots
from teleop.people.sampling import Split

Progress = Callable[[str, float], None]
GLOVES: Final = 0.15
BETWEEN: Final = 0.20
"""Chances of gloves and of a hand half closed in training; calibrated is on bare hands, open or a fist."""
_PHOTOS_OF_RENDERED: Final = 4000
"""Rendered boxes beside the real photographs in the colour network's training, at most."""


@dataclass(frozen=True, slots=True)
class HandRecipe:
    """people: rendered people to train on. validation: other people to calibrate on. seed: of weights and order."""

    people: int = 20_000
    validation: int = 1000
    epochs: int = 48
    seed: int = 7


@dataclass(frozen=True, slots=True)
class HandFigures:
    """What the training saw: hands, and the share right on validation people, or None for networks not tested."""

    hands: int
    right: dict[str, float]
    webcam_right: float | None


def _shots(split: Split, people: int, progress: Progress, kept: list[photos.Photo] | None) -> Iterator[HandShot]:
    """kept: gathers rendered boxes of bare hands; None: shots to calibrate on."""
    gloves, between = (0.0, 0.0) if kept is None else (GLOVES, BETWEEN)
    for number in range(people):
        for shot in hand_shots(number, split, gloves=gloves, between=between):
            definite = not shot.gloved and openness(shot.curl) in (0.0, 1.0)
            if kept is not None and definite and len(kept) < _PHOTOS_OF_RENDERED:
                photo = photos.rendered_photo(shot)
                kept += [] if photo is None else [photo]
            yield shot
        progress(f"rendering {split} people", (number + 1) / people)


def train_hands(recipe: HandRecipe, output: Path, progress: Progress) -> HandFigures:
    """Make the model file ``output`` and ``HANDS.md`` beside it. Raises DataError when a data set is missing."""
    if not output.parent.is_dir():
        raise DataError(f"cannot write {output}: its folder does not exist; choose another --output")
    config = HandConfig(max_ray_cos=1.0)
    boxes: list[photos.Photo] = []
    samples = collect(_shots("train", recipe.people, progress, boxes), config, recipe.seed)
    held = collect(_shots("validation", recipe.validation, progress, None), config, recipe.seed + 1, draws=1)
    networks: dict[str, Network] = {}
    right: dict[str, float] = {}
    sights: tuple[Sight, Sight] = ("both", "depth")
    for sight in sights:
        networks[sight], right[sight] = _network(sight, samples, held, recipe, progress)
    networks["base"], networks["color"], webcam = _photo_networks(boxes, recipe, progress)
    save_networks(output, networks)
    figures = HandFigures(len(samples.openness), right, webcam)
    output.with_name("HANDS.md").write_text(card(recipe, figures, output), encoding="utf-8")
    return figures


def _network(
    sight: Sight, samples: Samples, held: Samples, recipe: HandRecipe, progress: Progress
) -> tuple[Network, float]:
    layers = list(LAYERS_OF[sight])
    rng = np.random.default_rng([recipe.seed, len(layers)])
    schedule = Schedule(epochs=recipe.epochs)

    def show(epoch: int, _loss: float) -> None:
        progress(f"training the network of {sight}", epoch / recipe.epochs)

    start = initial(len(layers), rng)
    net = train(start, samples.patches[..., layers], samples.openness, schedule, rng, augmenter(sight), show)
    logit = net.logit(held.patches[:, 0][..., layers].astype(np.float32))
    is_open = held.openness > 0.5
    net = calibrated(net, logit, is_open)
    return net, float(((logit > 0) == is_open).mean())


def _photo_networks(
    boxes: list[photos.Photo], recipe: HandRecipe, progress: Progress
) -> tuple[Network, Network, float]:
    """The colour network before and after it saw webcams, and its share right on recordings left out."""
    config = HandConfig()
    digits = photos.photo_samples(photos.digit_photos(), config, photos.DIGITS_SEED)
    rendered = photos.photo_samples(boxes, config, recipe.seed)
    steps = 0

    def tell(_what: str) -> None:
        nonlocal steps
        steps += 1
        progress("training the network of photographs", min(1.0, steps / 30))

    base = photos.train_base(rendered, digits, recipe.seed, tell)
    held = photos.leave_recordings_out(base, digits, config, tell)
    progress("training the network of photographs", 1.0)
    right = float(((held.logit > 0) == held.is_open).mean())
    return base, photos.finished(base, digits, held, config), right


def card(recipe: HandRecipe, figures: HandFigures, output: Path) -> str:
    """Provenance of the model, as Markdown."""
    size_kb = output.stat().st_size / 1e3
    webcam = "" if figures.webcam_right is None else f"{100 * figures.webcam_right:.1f} %"
    return f"""# Hand model

| | |
|---|---|
| made by | `teleop train-hands --people {recipe.people} --epochs {recipe.epochs} --seed {recipe.seed}` |
| size | {size_kb:.0f} kB, three networks of three convolutions and two full layers, half precision |
| rendered | {figures.hands} hands of {recipe.people} people (MakeHuman, CC0; poses random or from the CMU motion \
capture database), all skin tones, light 0.55-1.15, walls and shirts in skin colours among them; open or a fist, \
{100 * BETWEEN:.0f} % half closed (answer: in between), {100 * GLOVES:.0f} % in gloves of any colour |
| real | colour network only: 412 photographs of open palms and closed hands, 119 webcam boxes of fists and palms, \
both data sets under Apache-2.0; no depth |
| joints | the true ones with white noise of 10, 18 or 30 mm in each axis |
| calibration | Platt scaling: rendered validation people; the webcam recordings left out |

Right on hands of rendered validation people, undecided ones counted by their nearer side: depth and colour \
{100 * figures.right["both"]:.1f} %, depth alone {100 * figures.right["depth"]:.1f} %. Webcam photographs by networks \
that never saw the recording: {webcam}. `teleop study hands` prints all of it.

The model knows hands from 1.4 to 3.5 m, bare or in gloves up to 4 mm thick. A hand half closed is left undecided or
answered by its nearer side; `teleop study hands` shows both.
"""
