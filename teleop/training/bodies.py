"""Rendered people for the networks: the images of ``teleop.training.dataset`` without their padding."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import numpy.typing as npt

from teleop.body.crop import body_centre
from teleop.body.features import FAR_MM
from teleop.errors import DataError
from teleop.training.dataset import CHUNK, Split, chunk_path


@dataclass(frozen=True, slots=True, eq=False)
class Bodies:
    """F canonical images cut to the person, in one array; frames that show nobody are left out.

    flat_mm: all pixels, int16, FAR_MM off the person. starts: (F,) index of each image's first pixel. sizes: (F, 2)
    width and height. intrinsics: (F, 4) fx, fy, cx, cy counted from the image's first pixel. centres: (F, 3) see
    body_centre. joints_m: (F, 20, 3). visible: (F, 20).
    """

    flat_mm: npt.NDArray[np.int16]
    starts: npt.NDArray[np.int64]
    sizes: npt.NDArray[np.int64]
    intrinsics: npt.NDArray[np.float64]
    centres: npt.NDArray[np.float64]
    joints_m: npt.NDArray[np.float64]
    visible: npt.NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.starts)


def cut_chunk(folder: Path, split: Split, first: int) -> Bodies:
    """The frames of one chunk. Raises DataError when its file is missing."""
    path = chunk_path(folder, split, first)
    if not path.is_file():
        raise DataError(f"training frames '{path}' are missing; run 'teleop train' again, it renders what is missing")
    with np.load(path) as data:
        flat, rows, joints_m, visible = (data[name] for name in ("flat_mm", "rows", "joints_m", "visible"))
    images, sizes, intrinsics, centres, kept = [], [], [], [], []
    begin = 0
    for f, (w, h, u0, v0, cx, cy, focal) in enumerate(rows):
        image = flat[begin : begin + int(w * h)].reshape(int(h), int(w))
        begin += int(w * h)
        body = image < FAR_MM
        r, c = np.flatnonzero(body.any(axis=1)), np.flatnonzero(body.any(axis=0))
        if len(r) == 0:
            continue
        cut = np.ascontiguousarray(image[r[0] : r[-1] + 1, c[0] : c[-1] + 1])
        height, width = cut.shape
        images.append(cut.reshape(-1))
        sizes.append((width, height))
        intrinsics.append((focal, focal, cx - u0 - c[0], cy - v0 - r[0]))
        centres.append(body_centre(images[-1], 0, width, height))
        kept.append(f)
    lengths = [len(image) for image in images]
    return Bodies(
        flat_mm=np.concatenate(images),
        starts=np.cumsum([0, *lengths[:-1]]).astype(np.int64),
        sizes=np.array(sizes, np.int64),
        intrinsics=np.array(intrinsics),
        centres=np.array(centres),
        joints_m=joints_m[kept],
        visible=visible[kept],
    )


def load_bodies(folder: Path, split: Split, frames: int, workers: int | None = None) -> Bodies:
    """Load rendered frames (rounded up to whole chunks) on all cores. Raises DataError when one is missing."""
    with ProcessPoolExecutor(workers) as pool:
        chunks = list(pool.map(partial(cut_chunk, folder, split), range(0, frames, CHUNK)))
    base = np.cumsum([0, *(len(chunk.flat_mm) for chunk in chunks[:-1])])
    flat_mm = np.empty(sum(len(chunk.flat_mm) for chunk in chunks), np.int16)
    for chunk, first in zip(chunks, base, strict=True):
        flat_mm[first : first + len(chunk.flat_mm)] = chunk.flat_mm
    return Bodies(
        flat_mm=flat_mm,
        starts=np.concatenate([chunk.starts + first for chunk, first in zip(chunks, base, strict=True)]),
        sizes=np.concatenate([chunk.sizes for chunk in chunks]),
        intrinsics=np.concatenate([chunk.intrinsics for chunk in chunks]),
        centres=np.concatenate([chunk.centres for chunk in chunks]),
        joints_m=np.concatenate([chunk.joints_m for chunk in chunks]),
        visible=np.concatenate([chunk.visible for chunk in chunks]),
    )


def body_image(bodies: Bodies, frame: int, dropout: float, rng: np.random.Generator) -> npt.NDArray[np.int16]:
    """Pixels of one frame. In a share ``dropout`` of the calls up to half of the pixels are lost."""
    width, height = bodies.sizes[frame]
    image = bodies.flat_mm[bodies.starts[frame] : bodies.starts[frame] + width * height]
    if rng.uniform() >= dropout:
        return image
    return np.where(rng.random(len(image), np.float32) < rng.uniform(0.0, 0.5), np.int16(FAR_MM), image)
