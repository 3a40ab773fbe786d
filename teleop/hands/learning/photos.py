"""Photographs of hands: two public data sets of real ones, and boxes cut from rendered ones."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import cv2
import numpy as np

from teleop.config.intent import HandConfig
from teleop.data import data_folder
from teleop.errors import DataError
from teleop.frames import ColorImage
from teleop.hands.aim import aim_at_hand
from teleop.hands.crop import color_at_depth
from teleop.hands.learning.convnet import Schedule, calibrated, initial, train
from teleop.hands.learning.samples import Samples, augmenter
from teleop.hands.learning.tally import Share
from teleop.hands.network import LAYERS_OF, Network, load_networks
from teleop.hands.patch import Patch
from teleop.hands.photo import photo_patch
from teleop.people.hand_shots import HandShot
from teleop.skeleton import Skeleton

Told = Callable[[str], None]
DRAWS: Final = 4
_OPEN_M, _FIST_M = (0.19, 0.025), (0.12, -0.005)
"""Side of a box round an open hand or a fist, and how far its middle lies ahead of the knuckles."""


@dataclass(frozen=True, slots=True, eq=False)
class Photo:
    """A hand cut from a photograph. recording: what must not be split between training and test."""

    box_rgb: ColorImage
    is_open: bool
    recording: str


def webcam_photos() -> list[Photo]:
    """The labelled boxes of the data set ``hands/webcam`` (Apache-2.0). Raises DataError when it is not there."""
    folder = data_folder("hands") / "webcam"
    try:
        rows = list(csv.DictReader((folder / "labels.csv").read_text().splitlines()))
    except OSError as error:
        raise DataError(f"{folder / 'labels.csv'} cannot be read ({error.strerror}); fetch it again") from error
    out = []
    for row in rows:
        image = _read(folder / "images" / row["filename"])
        x0, y0, x1, y1 = (int(row[k]) for k in ("xmin", "ymin", "xmax", "ymax"))
        prefix = row["filename"].split("_")[0] if "_" in row["filename"] else "pic"
        out.append(Photo(image[y0:y1, x0:x1], row["class"] == "5-hand", prefix))
    return out


def digit_photos() -> list[Photo]:
    """The photographs of ``hands/digits`` (Apache-2.0): open palms, and hands closed to an O."""
    out = []
    for name, is_open in (("5_open", True), ("0_closed_O", False)):
        files = sorted((data_folder("hands") / "digits" / name).iterdir())
        out += [Photo(_read(path), is_open, f"digits {path.stem}") for path in files]
    return out


def _read(path: Path) -> ColorImage:
    image = cv2.imread(str(path))
    if image is None:
        raise DataError(f"{path} is no picture that can be read; fetch the data set again")
    return cv2.cvtColor(image, cv2.COLOR_BGR2RGB).astype(np.uint8)


def rendered_photo(shot: HandShot) -> Photo | None:
    """A box round a rendered hand, as somebody would draw it; None when it does not fit into the window."""
    aim = aim_at_hand(Skeleton(0, shot.joints_m, np.ones(20)), shot.side, shot.frame.camera)
    color = color_at_depth(shot.frame)
    if aim is None or color is None or aim.ray_cos > 0.8:
        return None
    side_m, ahead_m = _OPEN_M if shot.curl < 0.5 else _FIST_M
    middle = np.array([aim.u, aim.v]) + ahead_m * aim.px_per_m * aim.direction
    half = max(4, round(0.5 * side_m * aim.px_per_m))
    u, v = round(middle[0]), round(middle[1])
    if u < half or v < half or u + half > color.shape[1] or v + half > color.shape[0]:
        return None
    return Photo(color[v - half : v + half, u - half : u + half], shot.curl < 0.5, "rendered")


def _zoomed(photo: Photo, rng: np.random.Generator) -> ColorImage:
    """The box cut a little closer or wider aside, and turned: boxes are drawn by hand."""
    h, w = photo.box_rgb.shape[:2]
    a = rng.uniform(0.0, 0.08, 4)
    box = photo.box_rgb[int(a[0] * h) : h - int(a[1] * h), int(a[2] * w) : w - int(a[3] * w)]
    turns = int(rng.integers(4)) if photo.recording == "rendered" else 0
    return np.ascontiguousarray(np.rot90(box, turns))


def photo_samples(photos: Iterable[Photo], config: HandConfig, seed: int) -> Samples:
    """Patches of photographs, each cut ``DRAWS`` times."""
    rng = np.random.default_rng(seed)
    patches, answers = [], []
    for photo in photos:
        patches.append(np.stack([photo_patch(_zoomed(photo, rng), config) for _ in range(DRAWS)]).astype(np.float16))
        answers.append(float(photo.is_open))
    return Samples(np.stack(patches), np.array(answers, np.float32))


def joined(*parts: tuple[Samples, int]) -> Samples:
    """Samples put together, each part repeated so many times."""
    return Samples(
        np.concatenate([s.patches for s, times in parts for _ in range(times)]),
        np.concatenate([s.openness for s, times in parts for _ in range(times)]),
    )


def whole_patches(photos: list[Photo], config: HandConfig) -> Patch:
    """One patch (N, SIZE, SIZE, 2) per photograph, its box as it is."""
    return np.stack([photo_patch(p.box_rgb, config) for p in photos])


BASE: Final = Schedule(epochs=14)
TUNE: Final = Schedule(epochs=6, rate=6e-4)
WEBCAM_TIMES: Final = 4
DIGITS_SEED: Final = 7


def train_base(rendered: Samples, digits: Samples, seed: int, tell: Told) -> Network:
    """The colour network before it has seen any webcam."""
    rng = np.random.default_rng(seed)
    both = joined((rendered, 1), (digits, 2))
    net = initial(len(LAYERS_OF["color"]), rng)

    def progress(epoch: int, loss: float) -> None:
        tell(f"colour network, epoch {epoch}: loss {loss:.3f}")

    return train(net, both.patches, both.openness, BASE, rng, augmenter("base"), progress)


def tuned(base: Network, webcam: Samples, digits: Samples, seed: int) -> Network:
    """The colour network after some epochs on webcam photographs, beside the digits so that it forgets nothing."""
    rng = np.random.default_rng(seed)
    both = joined((webcam, WEBCAM_TIMES), (digits, 1))
    return train(base, both.patches, both.openness, TUNE, rng, augmenter("color"), lambda _epoch, _loss: None)


@dataclass(frozen=True, slots=True, eq=False)
class WebcamResult:
    """Log odds (N,) of an open hand by networks that never saw the photograph's recording, and the truth."""

    logit: np.ndarray
    is_open: np.ndarray
    recording: list[str]


def leave_recordings_out(base: Network, digits: Samples, config: HandConfig, tell: Told) -> WebcamResult:
    """Every recording judged by a network tuned on the others; calibrated on those, too."""
    photos = webcam_photos()
    names = [p.recording for p in photos]
    logit = np.zeros(len(photos))
    for number, held_out in enumerate(sorted(set(names))):
        others = [p for p in photos if p.recording != held_out]
        net = tuned(base, photo_samples(others, config, number), digits, number)
        mine = [i for i, name in enumerate(names) if name == held_out]
        logit[mine] = net.logit(whole_patches([photos[i] for i in mine], config))
        tell(f"webcam, recording {held_out}: {len(mine)} photographs")
    return WebcamResult(logit, np.array([p.is_open for p in photos]), names)


def webcam_share(progress: Callable[[str, float], None]) -> Share:
    """How many webcam photographs are answered right by networks that never saw the recording; none is rejected.

    Begins from the shipped model's network that has seen no webcam. Raises DataError when a data set is missing.
    """
    config = HandConfig()
    digits = photo_samples(digit_photos(), config, DIGITS_SEED)
    recordings = len({photo.recording for photo in webcam_photos()})
    done = 0

    def tell(_what: str) -> None:
        nonlocal done
        done += 1
        progress("webcam recordings, each left out once", done / recordings)

    held = leave_recordings_out(load_networks()["base"], digits, config, tell)
    right = int(((held.logit > 0) == held.is_open).sum())
    return Share(len(held.logit), len(held.logit), right)


def finished(base: Network, digits: Samples, held: WebcamResult, config: HandConfig) -> Network:
    """The colour network that is shipped: tuned on all recordings, calibrated by the held-out answers."""
    photos = webcam_photos()
    net = tuned(base, photo_samples(photos, config, 0), digits, 0)
    return calibrated(net, held.logit, held.is_open)
