"""Stages of a training run kept on disk: a run that was cut off goes on after the last stage that was done."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

Arrays = Mapping[str, npt.NDArray[Any]]
T = TypeVar("T")


@dataclass(slots=True)
class Stages:
    """A folder of results. Each is kept under its name and a digest of what it was made from: its own settings and
    those of all stages before it."""

    folder: Path
    _made_from: list[str] = field(default_factory=list)

    def path(self, name: str) -> Path:
        """File of a stage with the settings so far."""
        digest = hashlib.sha256("\n".join(self._made_from).encode()).hexdigest()[:12]
        return self.folder / f"stage_{name}_{digest}.npz"

    def kept(
        self, name: str, settings: object, make: Callable[[], T], pack: Callable[[T], Arrays], of: Callable[[Arrays], T]
    ) -> T:
        """The result of a stage, read where it is kept, else made and kept. settings: what it depends on, beside the
        stages before; its ``repr`` counts."""
        self._made_from.append(f"{name} {settings!r}")
        path = self.path(name)
        if path.is_file():
            with np.load(path, allow_pickle=False) as data:
                return of(dict(data))
        result = make()
        self.folder.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(f".{os.getpid()}.part")
        with part.open("wb") as file:
            np.savez(file, allow_pickle=False, **pack(result))
        part.replace(path)
        return result
