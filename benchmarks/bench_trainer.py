"""Our forest trainer against scikit-learn's forests at equal wall time: same frames, same kind of features, two cores.

scikit-learn takes a table of features computed beforehand, so it chooses among one fixed pool of offset pairs (as the
best open implementation does) and sees as many pixels as it can learn from in our time, which is found by a trial on a
small part. Ours draws new offsets at every node (the published way) from all pixels. Scored: share of unseen
people's pixels given their true part.
"""

from __future__ import annotations

import os
import time
from typing import Any

import numba as nb
import numpy as np
import numpy.typing as npt

from benchmarks.training_data import forest_answer, rendered_images
from teleop.body.features import depth_difference
from teleop.body.model import OFFSET_UNIT_M
from teleop.errors import DataError
from teleop.evaluation.section import table
from teleop.training.images import Images, Pixels, draw_pixels
from teleop.training.leaves import fill_leaves
from teleop.training.trainer import TreeSpec, grow_tree, pixel_scales

_VALIDATION = 200
_PER_FRAME, _TREES = 150, 3
_POOL = 600
"""Offset pairs of scikit-learn's table; more do not fit beside the pixels it can use in the time."""
_TRIAL = 6000


@nb.njit(cache=True, nogil=True, parallel=True)
def _features(
    flat_mm: npt.NDArray[np.int16],
    at: npt.NDArray[np.int64],
    width: npt.NDArray[np.int32],
    sx: npt.NDArray[np.float32],
    sy: npt.NDArray[np.float32],
    offsets: npt.NDArray[np.int16],
) -> npt.NDArray[np.float32]:
    out = np.empty((len(at), len(offsets)), np.float32)
    for i in nb.prange(len(at)):
        for k in range(len(offsets)):
            out[i, k] = depth_difference(flat_mm, at[i], width[i], sx[i], sy[i], offsets, k)
    return out


def feature_table(images: Images, pixels: Pixels, offsets: npt.NDArray[np.int16]) -> npt.NDArray[np.float32]:
    """Depth differences (N, D) in mm of pixels at offset pairs (D, 4), by the sampler of training and run time."""
    across, down = pixel_scales(images, pixels)
    width = images.widths[pixels.frame % len(images)]
    return _features(images.flat_mm, pixels.at, width, across, down, offsets)


def some(pixels: Pixels, count: int, rng: np.random.Generator) -> Pixels:
    """A random part of the pixels."""
    chosen = np.sort(rng.choice(len(pixels.at), min(count, len(pixels.at)), replace=False))
    return Pixels(pixels.at[chosen], pixels.frame[chosen], pixels.part[chosen])


def ours(train: Images, test: Images, asked: Pixels) -> tuple[float, float, int]:
    """Pixel accuracy, seconds and pixels of our trainer."""
    draw_and_grow(train, 0, per_frame=2, depth=3)  # compiles
    start = time.perf_counter()
    grown = [draw_and_grow(train, number, _PER_FRAME, TreeSpec().depth) for number in range(_TREES)]
    seconds = time.perf_counter() - start
    answer = forest_answer(test, asked, [g[0] for g in grown], [g[1] for g in grown])
    return float((answer == asked.part).mean()), seconds, _TREES * len(train) * _PER_FRAME


def draw_and_grow(train: Images, number: int, per_frame: int, depth: int) -> tuple[Any, Any]:
    """One tree and its leaves from pixels of its own."""
    rng = np.random.default_rng([5, number])
    pixels = draw_pixels(train, per_frame, rng, 0.5)
    tree = [t for _, t in grow_tree(train, pixels, TreeSpec(depth=depth), int(rng.integers(2**31))) if t is not None][
        -1
    ]
    return tree, fill_leaves(train, draw_pixels(train, per_frame, rng, 0.0), tree, 1)


def theirs(kind: Any, train: Images, test: Images, asked: Pixels, seconds: float) -> tuple[float, float, int]:
    """The same of a scikit-learn forest that is given our time, features included."""
    rng = np.random.default_rng(6)
    half = round(TreeSpec().offset_m / OFFSET_UNIT_M)
    offsets = rng.integers(-half, half + 1, (_POOL, 4)).astype(np.int16)
    offsets[: int(0.4 * _POOL), 2:] = 0
    everything = draw_pixels(train, _PER_FRAME, rng, 0.5)

    def fit(count: int) -> tuple[Any, float]:
        start = time.perf_counter()
        pixels = some(everything, count, rng)
        forest = kind(
            n_estimators=_TREES, max_depth=TreeSpec().depth, min_samples_leaf=4, criterion="entropy",
            max_features=TreeSpec().candidates, n_jobs=os.cpu_count(), random_state=0,
        )  # fmt: skip
        forest.fit(feature_table(train, pixels, offsets), pixels.part)
        return forest, time.perf_counter() - start

    fit(500)
    trial_s = fit(_TRIAL)[1]
    # a forest costs n log n: one step of Newton on the logarithm is near enough
    count = int(_TRIAL * seconds / trial_s)
    count = int(_TRIAL * seconds / trial_s * np.log(_TRIAL) / np.log(max(count, _TRIAL)))
    count = min(count, len(everything.at))
    forest, spent = fit(count)
    answer = forest.predict(feature_table(test, asked, offsets))
    return float((answer == asked.part).mean()), spent, count


def main(frames: float = 2000) -> None:
    """Print the table. frames: to train on."""
    from sklearn.ensemble import ExtraTreesClassifier, RandomForestClassifier

    try:
        train, test = rendered_images(int(frames), _VALIDATION)
    except DataError as error:
        print(f"trainer: {error}")
        return
    asked = draw_pixels(test, 200, np.random.default_rng(4), 0.0)
    rows = []
    accuracy, seconds, count = ours(train, test, asked)
    rows.append(
        ["ours (numba, offsets drawn at every node)", f"{count}", f"{seconds / 60:.2f}", f"{100 * accuracy:.1f}"]
    )
    for kind in (RandomForestClassifier, ExtraTreesClassifier):
        accuracy, spent, count = theirs(kind, train, test, asked, seconds)
        name = f"scikit-learn {kind.__name__}, pool of {_POOL} offset pairs"
        rows.append([name, str(count), f"{spent / 60:.2f}", f"{100 * accuracy:.1f}"])
    print(f"{_TREES} trees, depth {TreeSpec().depth}, {len(train)} frames and mirror images, {os.cpu_count()} cores")
    print(table(("trainer", "pixels learned from", "minutes", "unseen people's pixels right %"), rows))


if __name__ == "__main__":
    main()
