"""Rendered training frames: made by many workers, kept in chunks on disk, so that a run that was cut off goes on.

Half of the frames are people cut out, with the faults of a segmentation; most others are whole scenes, from which the
segmentation cuts the operator later (``teleop.training.cutting``); in one of ten nobody is.
"""

from __future__ import annotations

import io
import logging
import os
from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
import numpy.typing as npt
import zstandard

from teleop.errors import DataError
from teleop.frames import Camera, kinect_v1
from teleop.parallel import Pool
from teleop.software import sources_digest

_log = logging.getLogger(__name__)
CHUNK: Final = 200
WIDTH: Final = 320
HEIGHT: Final = 240
"""The working resolution of the tracker (ForestConfig.working_focal_px)."""

Split = Literal["train", "validation", "test"]


class Kind(IntEnum):
    """What a training frame shows."""

    CUT_OUT = 0
    SCENE = 1
    NOBODY = 2


@dataclass(frozen=True, slots=True, eq=False)
class Frames:
    """F frames as the sensor reads them.

    depth_mm: (F, H, W) uint16. part: (F, H, W) uint8 of the operator, NO_PART elsewhere. others: (F, H, W) bool, other
    people. kind: (F,) see Kind. mirrored: (F,) bool. joints_m: (F, 20, 3) camera axes, NaN where nobody is.
    visible: (F, 20) bool.
    """

    depth_mm: npt.NDArray[np.uint16]
    part: npt.NDArray[np.uint8]
    others: npt.NDArray[np.bool_]
    kind: npt.NDArray[np.uint8]
    mirrored: npt.NDArray[np.bool_]
    joints_m: npt.NDArray[np.float64]
    visible: npt.NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.kind)

    def camera(self, f: int) -> Camera:
        """The camera of a frame."""
        height, width = self.depth_mm.shape[1:]
        return Camera(kinect_v1(width, height), bool(self.mirrored[f]))


def chunk_path(folder: Path, split: Split, first: int) -> Path:
    """File of the frames ``first .. first + CHUNK``."""
    return folder / f"{split}_{first:07d}.npz"


@dataclass(frozen=True, slots=True)
class ChunkTask:
    """Frames ``first .. first + count`` of a split; seeds are their numbers."""

    split: Split
    first: int
    count: int


def render_chunk(task: ChunkTask) -> bytes:
    """Render frames from their seeds: an .npz, see read_chunk. Same task: same bytes."""
    from teleop.people.sampling import SampleSpec, sample_frame
    from teleop.people.training_scenes import sample_scene

    size = (task.count, HEIGHT, WIDTH)
    out = Frames(
        np.zeros(size, np.uint16),
        np.zeros(size, np.uint8),
        np.zeros(size, np.bool_),
        np.zeros(task.count, np.uint8),
        np.zeros(task.count, np.bool_),
        np.zeros((task.count, 20, 3)),
        np.zeros((task.count, 20), np.bool_),
    )
    for n in range(task.count):
        seed = task.first + n
        rng = np.random.default_rng([91, seed])
        kind = Kind(int(rng.choice(3, p=(0.5, 0.4, 0.1))))
        mirrored = bool(rng.uniform() < 0.5)
        if kind is Kind.CUT_OUT:
            shot = sample_frame(seed, SampleSpec(task.split, WIDTH, HEIGHT, mirrored=mirrored, any_sensor=True))
            frame, part, joints, visible = shot.frame, shot.part, shot.joints_m, shot.visible
        else:
            scene = sample_scene(seed, task.split, WIDTH, HEIGHT, mirrored=mirrored, nobody=kind is Kind.NOBODY)
            frame, part, joints, visible = scene.frame, scene.part, scene.joints_m, scene.visible
            out.others[n] = scene.others
        out.depth_mm[n], out.part[n], out.kind[n], out.mirrored[n] = frame.depth_mm, part, kind, mirrored
        out.joints_m[n], out.visible[n] = joints, visible
    return _packed(out)


def _packed(frames: Frames) -> bytes:
    squeeze = zstandard.ZstdCompressor(level=3)

    def blob(pixels: npt.NDArray[Any]) -> npt.NDArray[np.uint8]:
        return np.frombuffer(squeeze.compress(pixels.tobytes()), np.uint8)

    file = io.BytesIO()
    np.savez(
        file,
        size=np.array(frames.depth_mm.shape),
        depth_mm=blob(frames.depth_mm),
        part=blob(frames.part),
        others=blob(np.packbits(frames.others)),
        kind=frames.kind,
        mirrored=frames.mirrored,
        joints_m=frames.joints_m,
        visible=frames.visible,
        made_by=np.array(_renderer()),
    )
    return file.getvalue()


def read_chunk(folder: Path, split: Split, first: int) -> Frames:
    """The frames of one chunk. Raises DataError when its file is missing."""
    path = chunk_path(folder, split, first)
    if not path.is_file():
        raise DataError(f"training frames '{path}' are missing; run 'teleop train' again, it renders what is missing")
    unpack = zstandard.ZstdDecompressor()
    with np.load(path) as data:
        size = tuple(data["size"])
        depth = np.frombuffer(unpack.decompress(data["depth_mm"].tobytes()), np.uint16).reshape(size)
        part = np.frombuffer(unpack.decompress(data["part"].tobytes()), np.uint8).reshape(size)
        bits = np.frombuffer(unpack.decompress(data["others"].tobytes()), np.uint8)
        others = np.unpackbits(bits, count=int(np.prod(size))).reshape(size).astype(np.bool_)
        return Frames(depth, part, others, data["kind"], data["mirrored"], data["joints_m"], data["visible"])


def render_dataset(folder: Path, split: Split, frames: int, pool: Pool) -> Iterator[tuple[int, int]]:
    """Render what is missing of ``frames`` frames; yields (chunks done, chunks in all) after each chunk.

    The workers send chunks back, so that they need no folder in common with the caller.
    """
    folder.mkdir(parents=True, exist_ok=True)
    firsts = range(0, frames, CHUNK)
    missing = [first for first in firsts if not chunk_path(folder, split, first).is_file()]
    done = len(firsts) - len(missing)
    _warn_of_others([chunk_path(folder, split, first) for first in firsts if first not in set(missing)])
    yield done, len(firsts)
    tasks = [ChunkTask(split, first, CHUNK) for first in missing]
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
