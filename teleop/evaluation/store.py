"""Rendered frames kept on disk under a name made of what was asked for and of the code that draws it."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import lru_cache
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Protocol

import cv2
import numpy as np

import teleop.evaluation
import teleop.people
from teleop.evaluation.cases import Case
from teleop.evaluation.sampled import Sampled
from teleop.frames import Camera, DepthFrame, Intrinsics

OURS = ("cases", "stills", "motions", "nobody", "sampled", "poses", "objects")
PEOPLE = ("body", "clothes", "makehuman", "motion", "pose", "render", "rig", "room", "scene", "sensor", "shape", "view")
SAMPLER = ("sampling", "moves", "mocap", "clutter")
"""Modules of this package, and of teleop.people, whose code decides what a frame looks like; SAMPLER only Sampled."""


class FrameSet(Protocol):
    """A frozen dataclass that draws its frames a batch at a time; equal fields and index give equal frames."""

    def batch(self, index: int) -> list[Case]: ...


@lru_cache(maxsize=2)
def code_print(sampler: bool) -> str:
    """Fingerprint of the code that draws people and rooms: changed code means other frames."""
    ours, people = (Path(str(m.__file__)).parent for m in (teleop.evaluation, teleop.people))
    digest = hashlib.sha256()
    names = PEOPLE + (SAMPLER if sampler else ())
    for path in [*(ours / f"{name}.py" for name in OURS), *(people / f"{name}.py" for name in names)]:
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()


def default_folder() -> Path:
    """Where frames are kept when no folder is named: the user's cache."""
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "greenhouse-teleop" / "evaluation"


@dataclass(frozen=True, slots=True)
class FrameStore:
    """folder: None keeps nothing. workers: processes that render what is missing."""

    folder: Path | None
    workers: int = 1

    def path(self, frames: FrameSet, index: int) -> Path | None:
        """File of one batch."""
        if self.folder is None:
            return None
        asked = json.dumps([type(frames).__name__, asdict(frames)], sort_keys=True)  # type: ignore[call-overload]
        name = hashlib.sha256((asked + code_print(isinstance(frames, Sampled))).encode()).hexdigest()[:20]
        return self.folder / name / f"{index:05d}.npz"

    def cases(
        self, frames: FrameSet, batches: int, advance: Callable[[], None] = lambda: None, first: int = 0
    ) -> Iterator[Case]:
        """The frames of ``batches`` batches from number ``first`` on, in order, rendered where they are not kept yet.

        advance: called once a batch. Raises DataError when a data set that the drawing needs is missing.
        """
        numbers = range(first, first + batches)
        paths = {n: self.path(frames, n) for n in numbers}
        missing = [n for n, path in paths.items() if path is None or not path.is_file()]
        if min(self.workers, len(missing)) > 1:
            with ProcessPoolExecutor(min(self.workers, len(missing)), mp_context=get_context("spawn")) as pool:
                futures = {n: pool.submit(_made, frames, n, paths[n]) for n in missing}
                for n, path in paths.items():
                    yield from futures.pop(n).result() if n in futures else _read(path)
                    advance()
            return
        for n, path in paths.items():
            yield from _made(frames, n, path) if n in missing else _read(path)
            advance()


def _made(frames: FrameSet, index: int, path: Path | None) -> list[Case]:
    cases = frames.batch(index)
    if path is not None:
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(f".{os.getpid()}.tmp")
        with part.open("wb") as file:
            np.savez(file, **_packed(cases))
        part.replace(path)
    return cases


def _png(image: np.ndarray) -> np.ndarray:
    done, data = cv2.imencode(".png", image, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    if not done:
        raise ValueError(f"an image of shape {image.shape} cannot be packed")
    return data.ravel()


def _packed(cases: list[Case]) -> dict[str, Any]:
    out: dict[str, Any] = {
        "camera": np.array(json.dumps([asdict(c.frame.camera) for c in cases])),
        "joints_m": np.stack([c.joints_m for c in cases]),
        "counted": np.stack([c.counted for c in cases]),
        "group": np.array([c.group for c in cases]),
        "level": np.array([c.level for c in cases]),
        "t_ns": np.array([c.frame.t_ns for c in cases]),
        "seq": np.array([c.frame.seq for c in cases]),
    }
    for n, case in enumerate(cases):
        out[f"depth{n}"] = _png(case.frame.depth_mm)
        if case.part is not None:
            out[f"part{n}"] = _png(case.part)
        if case.R_level_camera is not None:
            out[f"R{n}"] = case.R_level_camera
        if case.frame.color_rgb is not None:
            out[f"color{n}"] = _png(case.frame.color_rgb[..., ::-1])
    return out


def _camera(fields: dict[str, Any]) -> Camera:
    return Camera(Intrinsics(**fields["depth"]), fields["mirrored"])


def _image(data: Any, name: str) -> Any:
    return cv2.imdecode(data[name], cv2.IMREAD_UNCHANGED) if name in data else None


def _read(path: Path | None) -> list[Case]:
    assert path is not None
    out = []
    with np.load(path) as data:
        cameras = [_camera(c) for c in json.loads(str(data["camera"]))]
        for n, camera in enumerate(cameras):
            color = _image(data, f"color{n}")
            rgb = None if color is None else np.ascontiguousarray(color[..., ::-1])
            frame = DepthFrame(int(data["t_ns"][n]), _image(data, f"depth{n}"), camera, rgb, int(data["seq"][n]))
            R = data.get(f"R{n}")
            part = _image(data, f"part{n}")
            group = int(data["group"][n])
            out.append(Case(frame, data["joints_m"][n], data["counted"][n], part, R, group, float(data["level"][n])))
    return out
