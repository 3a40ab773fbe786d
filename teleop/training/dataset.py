"""Rendered training frames: made by many workers, kept in chunks on disk (a cut-off run goes on), loaded padded."""

from __future__ import annotations

import io
import logging
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import numpy as np
import numpy.typing as npt

from teleop.body.features import FAR_MM, pad_image
from teleop.body.parts import MIRROR_PART, N_PARTS, NO_PART
from teleop.errors import DataError
from teleop.parallel import Pool
from teleop.software import sources_digest

_log = logging.getLogger(__name__)
CHUNK: Final = 200
WIDTH: Final = 320
HEIGHT: Final = 240
"""The working resolution of the tracker (ForestConfig.working_focal_px)."""

Split = Literal["train", "validation", "test"]


@dataclass(frozen=True, slots=True, eq=False)
class Images:
    """Many padded canonical images in one array. F frames.

    flat_mm: all pixels, int16, FAR_MM off the person. part: uint8 labels, same layout. starts: (F,) int64 index of
    each image's first pixel. widths, heights: (F,). u0, v0, cx, cy, focal_px: (F,) as in PaddedImage (fx = fy).
    joints_m: (F, 20, 3). visible: (F, 20).
    """

    flat_mm: npt.NDArray[np.int16]
    part: npt.NDArray[np.uint8]
    starts: npt.NDArray[np.int64]
    widths: npt.NDArray[np.int32]
    heights: npt.NDArray[np.int32]
    u0: npt.NDArray[np.int32]
    v0: npt.NDArray[np.int32]
    cx: npt.NDArray[np.float64]
    cy: npt.NDArray[np.float64]
    focal_px: npt.NDArray[np.float64]
    joints_m: npt.NDArray[np.float64]
    visible: npt.NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.starts)


def chunk_path(folder: Path, split: Split, first: int) -> Path:
    """File of the frames ``first .. first + CHUNK``."""
    return folder / f"{split}_{first:07d}.npz"


@dataclass(frozen=True, slots=True)
class ChunkTask:
    """Frames ``first .. first + count`` of a split; seeds are their numbers. max_offset_m: see pad_image."""

    split: Split
    first: int
    count: int
    max_offset_m: float


def render_chunk(task: ChunkTask) -> bytes:
    """Render frames from their seeds: an .npz of what training needs of them. Same task: same bytes.

    Odd seeds are mirrored images: the sensor's shadow falls on the other side.
    """
    from teleop.people.sampling import SampleSpec, sample_frame

    images, parts, rows = [], [], []
    joints = np.zeros((task.count, 20, 3))
    visible = np.zeros((task.count, 20), bool)
    for n in range(task.count):
        seed = task.first + n
        shot = sample_frame(seed, SampleSpec(split=task.split, width=WIDTH, height=HEIGHT, mirrored=bool(seed % 2)))
        frame = shot.frame
        mask = frame.depth_mm > 0
        r, c = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
        box = (int(c[0]), int(r[0]), int(c[-1]) + 1, int(r[-1]) + 1) if len(r) else (0, 0, 1, 1)
        image = pad_image(frame.depth_mm, mask, box, frame.camera, task.max_offset_m, 1)
        height, width = image.depth_mm.shape
        pad_u, pad_v = (width - (box[2] - box[0])) // 2, (height - (box[3] - box[1])) // 2
        label = np.full((height, width), NO_PART, np.uint8)
        crop = shot.part[box[1] : box[3], box[0] : box[2]]
        label[pad_v : height - pad_v, pad_u : width - pad_u] = crop if frame.camera.mirrored else crop[:, ::-1]
        label[image.depth_mm >= FAR_MM] = NO_PART
        images.append(image.depth_mm.reshape(-1))
        parts.append(label.reshape(-1))
        rows.append((width, height, image.u0, image.v0, image.cx, image.cy, image.fx))
        joints[n], visible[n] = shot.joints_m, shot.visible
    packed = io.BytesIO()
    np.savez_compressed(
        packed,
        flat_mm=np.concatenate(images),
        part=np.concatenate(parts),
        rows=np.array(rows, np.float64),
        joints_m=joints,
        visible=visible,
        made_by=np.array(_renderer()),
    )
    return packed.getvalue()


def render_dataset(
    folder: Path, split: Split, frames: int, max_offset_m: float, pool: Pool
) -> Iterator[tuple[int, int]]:
    """Render what is missing of ``frames`` frames; yields (chunks done, chunks in all) after each chunk.

    The workers send chunks back, so that they need no folder in common with the caller.
    """
    folder.mkdir(parents=True, exist_ok=True)
    firsts = range(0, frames, CHUNK)
    missing = [first for first in firsts if not chunk_path(folder, split, first).is_file()]
    done = len(firsts) - len(missing)
    _warn_of_others([chunk_path(folder, split, first) for first in firsts if first not in set(missing)])
    yield done, len(firsts)
    tasks = [ChunkTask(split, first, CHUNK, max_offset_m) for first in missing]
    for outcome in pool.run(render_chunk, tasks):
        path = chunk_path(folder, split, outcome.task.first)
        part = path.with_suffix(f".{os.getpid()}.part")
        part.write_bytes(outcome.value())
        part.replace(path)
        done += 1
        yield done, len(firsts)


def _renderer() -> str:
    """What decides the pixels of a frame beside its seed."""
    return sources_digest("teleop.people")


def _warn_of_others(paths: list[Path]) -> None:
    """Frames made by another version of the renderer are used, but not silently."""
    others = 0
    for path in paths:
        with np.load(path) as data:
            others += "made_by" not in data or str(data["made_by"]) != _renderer()
    if others:
        _log.warning(
            "%d of %d chunks in %s were rendered by another version; remove them to have them rendered anew",
            others,
            len(paths),
            paths[0].parent,
        )


def load_images(folder: Path, split: Split, frames: int) -> Images:
    """Load rendered frames (rounded up to whole chunks). Raises DataError when one is missing."""
    paths = [chunk_path(folder, split, first) for first in range(0, frames, CHUNK)]
    for path in paths:
        if not path.is_file():
            raise DataError(
                f"training frames '{path}' are missing; run 'teleop train' again, it renders what is missing"
            )
    small = []
    for path in paths:
        with np.load(path) as data:
            small.append({name: data[name] for name in ("rows", "joints_m", "visible")})
    rows = np.concatenate([c["rows"] for c in small])
    sizes = (rows[:, 0] * rows[:, 1]).astype(np.int64)
    starts = np.concatenate([[0], np.cumsum(sizes)])
    # filled chunk by chunk: joining copies would need twice the memory
    flat_mm, part = np.empty(starts[-1], np.int16), np.empty(starts[-1], np.uint8)
    for n, path in enumerate(paths):
        with np.load(path) as data:
            piece = slice(starts[n * CHUNK], starts[(n + 1) * CHUNK])
            flat_mm[piece], part[piece] = data["flat_mm"], data["part"]
    return Images(
        flat_mm=flat_mm,
        part=part,
        starts=starts[:-1],
        widths=rows[:, 0].astype(np.int32),
        heights=rows[:, 1].astype(np.int32),
        u0=rows[:, 2].astype(np.int32),
        v0=rows[:, 3].astype(np.int32),
        cx=rows[:, 4],
        cy=rows[:, 5],
        focal_px=rows[:, 6],
        joints_m=np.concatenate([c["joints_m"] for c in small]),
        visible=np.concatenate([c["visible"] for c in small]),
    )


@dataclass(frozen=True, slots=True, eq=False)
class Pixels:
    """Training pixels. at: (N,) int64 index into flat_mm. frame: (N,) int32, F + f for the mirror image of frame f.
    part: (N,) uint8, mirrored there too."""

    at: npt.NDArray[np.int64]
    frame: npt.NDArray[np.int32]
    part: npt.NDArray[np.uint8]


def draw_pixels(images: Images, per_frame: int, rng: np.random.Generator, balance: float) -> Pixels:
    """Draw pixels of every frame, half of them for its mirror image.

    balance: share of the pixels drawn with equal chances for every part in the frame (class balance); the rest is
    drawn evenly over the person.
    """
    mirror = np.array([*MIRROR_PART, *range(N_PARTS, 256)], np.uint8)
    at, frame, part = [], [], []
    for f in range(len(images)):
        start = images.starts[f]
        labels = images.part[start : start + int(images.widths[f]) * int(images.heights[f])]
        body = np.flatnonzero(labels != NO_PART)
        if len(body) == 0:
            continue
        chance = np.full(len(body), (1 - balance) / len(body))
        counts = np.bincount(labels[body], minlength=N_PARTS)
        chance += balance / (counts[labels[body]] * np.count_nonzero(counts))
        chosen = body[
            np.searchsorted(np.cumsum(chance), rng.uniform(0, chance.sum(), per_frame)).clip(0, len(body) - 1)
        ]
        flipped = np.arange(per_frame) % 2 == 1
        at.append(start + chosen)
        frame.append(np.where(flipped, len(images) + f, f).astype(np.int32))
        part.append(np.where(flipped, mirror[labels[chosen]], labels[chosen]))
    return Pixels(np.concatenate(at), np.concatenate(frame), np.concatenate(part).astype(np.uint8))
