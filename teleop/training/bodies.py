"""Rendered operators for training, cut out as the tracker cuts them: canonical images without padding.

People rendered alone are cut out already. From whole scenes the tracker's own segmentation cuts the operator, so that
training sees its faults: pieces of furniture, other people, limbs that are missing.
"""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, fields, replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from teleop.body.features import FAR_MM, Pixels
from teleop.body.finder import Finder
from teleop.body.parts import NO_PART
from teleop.body.segmentation import candidate, look, rank
from teleop.config.body import BodyConfig
from teleop.frames import DepthFrame
from teleop.training.dataset import CHUNK, Frames, Kind, Split, read_chunk

LEAST_SHARE: Final = 0.4
"""A cut that holds less than this of the operator's pixels is none of them."""
LEAST_PX: Final = 300

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Bodies:
    """F canonical images cut to the operator's box, in one array; frames that show nobody are left out.

    flat_mm: all pixels, int16, FAR_MM off the operator. part: the same layout, uint8, NO_PART off the operator; may end
    earlier.
    starts: (F,) index of each image's first pixel. sizes: (F, 2) width and height. intrinsics: (F, 4) fx, fy, cx, cy
    counted from the image's first pixel. joints_m: (F, 20, 3). visible: (F, 20).
    """

    flat_mm: npt.NDArray[np.int16]
    part: npt.NDArray[np.uint8]
    starts: npt.NDArray[np.int64]
    sizes: npt.NDArray[np.int64]
    intrinsics: Floats
    joints_m: Floats
    visible: npt.NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.starts)

    def image(self, frame: int) -> npt.NDArray[np.int16]:
        """The pixels of one frame, row by row."""
        width, height = self.sizes[frame]
        return self.flat_mm[self.starts[frame] : self.starts[frame] + width * height]

    def pixels(self, frame: int) -> Pixels:
        """One frame as the networks see it."""
        width, height = self.sizes[frame]
        return Pixels(self.flat_mm, int(self.starts[frame]), int(width), int(height), self.intrinsics[frame])

    def labelled(self) -> Bodies:
        """The first frames, those whose parts are there, sharing their pixels."""
        count = int(np.searchsorted(self.starts + self.sizes.prod(axis=1), len(self.part), side="right"))
        rows = {f.name: getattr(self, f.name)[:count] for f in fields(self) if f.name not in ("flat_mm", "part")}
        return Bodies(flat_mm=self.flat_mm, part=self.part, **rows)


def operator_mask(frames: Frames, f: int, finder: Finder | None, config: BodyConfig) -> npt.NDArray[np.bool_] | None:
    """Pixels (H, W) that are taken for the operator of a frame; None where there are hardly any."""
    depth = frames.depth_mm[f]
    if frames.kind[f] == Kind.CUT_OUT:
        mask = (depth > 0) & (depth < FAR_MM)
        return mask if int(mask.sum()) >= LEAST_PX else None
    frame = DepthFrame(0, depth, frames.camera(f))
    scene = look(frame, None, finder, config.floor, config.segmentation)
    own = frames.part[f] != NO_PART
    best, share = None, LEAST_SHARE
    for label in rank(scene, None, config.segmentation):
        found = candidate(frame, scene, label, config.segmentation)
        if found is not None and (held := float((found.mask & own).sum()) / max(1, int(own.sum()))) > share:
            best, share = found.mask & (depth < FAR_MM), held
    return best if best is not None and int(best.sum()) >= LEAST_PX else None


def cut(frames: Frames, finder: Finder | None, config: BodyConfig) -> Bodies:
    """The operators of these frames."""
    images, parts, sizes, intrinsics, kept = [], [], [], [], []
    for f in range(len(frames)):
        mask = None if frames.kind[f] == Kind.NOBODY else operator_mask(frames, f, finder, config)
        if mask is None:
            continue
        rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        box = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        image = np.where(mask[box], frames.depth_mm[f][box], FAR_MM).astype(np.int16)
        part = np.where(mask[box], frames.part[f][box], NO_PART).astype(np.uint8)
        camera = frames.camera(f)
        k, height, width = camera.depth, *image.shape
        cx = k.cx - columns[0]
        if not camera.mirrored:
            image, part, cx = image[:, ::-1], part[:, ::-1], width - 1 - cx
        images.append(np.ascontiguousarray(image).reshape(-1))
        parts.append(np.ascontiguousarray(part).reshape(-1))
        sizes.append((width, height))
        intrinsics.append((k.fx, k.fy, cx, k.cy - rows[0]))
        kept.append(f)
    lengths = [len(image) for image in images]
    return Bodies(
        flat_mm=np.concatenate([*images, np.zeros(0, np.int16)]),
        part=np.concatenate([*parts, np.zeros(0, np.uint8)]),
        starts=np.cumsum([0, *lengths])[:-1].astype(np.int64),
        sizes=np.array(sizes, np.int64).reshape(-1, 2),
        intrinsics=np.array(intrinsics).reshape(-1, 4),
        joints_m=frames.joints_m[kept],
        visible=frames.visible[kept],
    )


def _cut_chunk(folder: Path, split: Split, finder: Finder | None, config: BodyConfig, parts: int, first: int) -> Bodies:
    bodies = cut(read_chunk(folder, split, first), finder, config)
    return bodies if first < parts else replace(bodies, part=bodies.part[:0])


def _one_array(pieces: list[npt.NDArray[Any]]) -> npt.NDArray[Any]:
    """The pieces as one array; each is let go when it has been copied, so that memory holds them once."""
    out = np.empty((sum(len(piece) for piece in pieces), *pieces[0].shape[1:]), pieces[0].dtype)
    at = 0
    while pieces:
        piece = pieces.pop(0)
        out[at : at + len(piece)] = piece
        at += len(piece)
    return out


def joined(chunks: Iterable[Bodies]) -> Bodies:
    """Bodies of many chunks as one."""
    rows: dict[str, list[Any]] = {f.name: [] for f in fields(Bodies)}
    base = 0
    for chunk in chunks:
        for name, column in rows.items():
            column.append(chunk.starts + base if name == "starts" else getattr(chunk, name))
        base += len(chunk.flat_mm)
    return Bodies(**{name: _one_array(column) for name, column in rows.items()})


def load_bodies(
    folder: Path,
    split: Split,
    frames: int,
    finder: Finder | None,
    config: BodyConfig,
    workers: int | None = None,
    parts: int | None = None,
) -> Bodies:
    """The operators of rendered frames (rounded up to whole chunks), cut on all cores; with the part labels of the
    first ``parts`` frames, by default of all. Raises DataError when a chunk is missing."""
    wanted = frames if parts is None else parts
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        work = partial(_cut_chunk, folder, split, finder, config, wanted)
        return joined(pool.map(work, range(0, frames, CHUNK)))


def thinned(image: Pixels, share: float, rng: np.random.Generator) -> Pixels:
    """The image with up to half of its pixels lost, in a share of the calls."""
    if rng.uniform() >= share:
        return image
    flat = image.flat_mm[image.first : image.first + image.width * image.height]
    lost = rng.random(len(flat), np.float32) < rng.uniform(0.0, 0.5)
    return replace(image, flat_mm=np.where(lost, np.int16(FAR_MM), flat), first=0)
