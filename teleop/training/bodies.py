"""Rendered operators for training, cut out as the tracker cuts them: canonical images without padding.

People rendered alone are cut out already. From whole scenes the tracker's own segmentation cuts the operator, so that
training sees its faults: pieces of furniture, other people, limbs that are missing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt
import zstandard

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
    """F canonical images cut to the operator's box; frames that show nobody are left out.

    depth: F compressed images, int16 mm row by row, FAR_MM off the operator: a tenth of their size, so that memory
    holds them all. part: compressed labels of the first of them, uint8, NO_PART off the operator. sizes: (F, 2) width
    and height. intrinsics: (F, 4) fx, fy, cx, cy counted from the image's first pixel. joints_m: (F, 20, 3).
    visible: (F, 20).
    """

    depth: list[bytes]
    part: list[bytes]
    sizes: npt.NDArray[np.int64]
    intrinsics: Floats
    joints_m: Floats
    visible: npt.NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.depth)

    def image(self, frame: int) -> npt.NDArray[np.int16]:
        """The pixels of one frame, row by row."""
        return np.frombuffer(zstandard.decompress(self.depth[frame]), np.int16)

    def labels(self, frame: int) -> npt.NDArray[np.uint8]:
        """The parts of one of the first frames, row by row."""
        return np.frombuffer(zstandard.decompress(self.part[frame]), np.uint8)

    def pixels(self, frame: int) -> Pixels:
        """One frame as the networks see it."""
        width, height = self.sizes[frame]
        return Pixels(self.image(frame), 0, int(width), int(height), self.intrinsics[frame])

    def labelled(self) -> Bodies:
        """The first frames, those whose parts are there."""
        n = len(self.part)
        return Bodies(
            self.depth[:n], self.part, self.sizes[:n], self.intrinsics[:n], self.joints_m[:n], self.visible[:n]
        )


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
    squeeze = zstandard.ZstdCompressor(level=1)
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
        images.append(squeeze.compress(image.tobytes()))
        parts.append(squeeze.compress(part.tobytes()))
        sizes.append((width, height))
        intrinsics.append((k.fx, k.fy, cx, k.cy - rows[0]))
        kept.append(f)
    return Bodies(
        images,
        parts,
        np.array(sizes, np.int64).reshape(-1, 2),
        np.array(intrinsics).reshape(-1, 4),
        frames.joints_m[kept],
        frames.visible[kept],
    )


def _cut_chunk(folder: Path, split: Split, finder: Finder | None, config: BodyConfig, parts: int, first: int) -> Bodies:
    bodies = cut(read_chunk(folder, split, first), finder, config)
    return bodies if first < parts else replace(bodies, part=[])


def joined(chunks: Iterable[Bodies]) -> Bodies:
    """Bodies of many chunks as one."""
    many = list(chunks)
    return Bodies(
        [one for c in many for one in c.depth],
        [one for c in many for one in c.part],
        np.concatenate([c.sizes for c in many]),
        np.concatenate([c.intrinsics for c in many]),
        np.concatenate([c.joints_m for c in many]),
        np.concatenate([c.visible for c in many]),
    )


def bodies_arrays(bodies: Bodies) -> dict[str, npt.NDArray[Any]]:
    """All arrays, by name."""
    out: dict[str, npt.NDArray[Any]] = {
        name: getattr(bodies, name) for name in ("sizes", "intrinsics", "joints_m", "visible")
    }
    for name, images in (("depth", bodies.depth), ("part", bodies.part)):
        out[name] = np.frombuffer(b"".join(images), np.uint8)
        out[f"{name}_ends"] = np.cumsum([len(one) for one in images], dtype=np.int64)
    return out


def bodies_of(data: Mapping[str, npt.NDArray[Any]]) -> Bodies:
    """The bodies of such arrays."""

    def pieces(name: str) -> list[bytes]:
        ends = data[f"{name}_ends"]
        starts = np.concatenate([np.zeros(1, np.int64), ends[:-1]])
        return [data[name][a:b].tobytes() for a, b in zip(starts, ends, strict=True)] if len(ends) else []

    return Bodies(pieces("depth"), pieces("part"), data["sizes"], data["intrinsics"], data["joints_m"], data["visible"])


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
    lost = rng.random(len(image.flat_mm), np.float32) < rng.uniform(0.0, 0.5)
    return replace(image, flat_mm=np.where(lost, np.int16(FAR_MM), image.flat_mm))
