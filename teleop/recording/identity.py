"""What a recording was made with, so that a replay knows whether it may expect the very same bits."""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt
from llvmlite import binding

from teleop.body.model import BodyModel
from teleop.recording import topics
from teleop.software import software_version, sources_digest

KEY_SOURCES: Final = "sources_sha256"
KEY_LIBRARIES: Final = "libraries"
KEY_HANDS: Final = "hand_model_sha256"
_LIBRARIES: Final = ("numpy", "numba", "llvmlite", "scipy", "opencv-python-headless", "pybullet")
_DECIDING: Final = ("robot_sim", "teleop")
_BESIDE: Final = ("robot_sim.studies", "teleop.people", "teleop.training", "teleop.evaluation", "teleop.parallel")
"""Packages that a session does not run through."""


def identity(model: BodyModel, *more: str) -> dict[str, str]:
    """What the bits of a session depend on beside its settings and inputs, as metadata of a recording.

    more: further packages whose sources decide, of those who call this.
    """
    return {
        topics.KEY_SOFTWARE: software_version(),
        KEY_SOURCES: sources_digest(*_DECIDING, *more, without=_BESIDE),
        KEY_LIBRARIES: " ".join(f"{name} {_version(name)}" for name in _LIBRARIES),
        topics.KEY_MODEL: model_digest(model),
        KEY_HANDS: _hand_model_digest(),
        topics.KEY_PROCESSOR: f"{platform.machine()} {binding.get_host_cpu_name()}",
    }


def _version(library: str) -> str:
    try:
        return version(library)
    except PackageNotFoundError:
        return "?"


def model_digest(model: BodyModel) -> str:
    """SHA-256 of all a body model computes with; its provenance does not count."""
    digest = hashlib.sha256()
    for name, value in _leaves("", model):
        digest.update(f"{name} {value.dtype.str} {value.shape}\n".encode())
        digest.update(np.ascontiguousarray(value).tobytes())
    return digest.hexdigest()


def _leaves(name: str, value: Any) -> Iterator[tuple[str, npt.NDArray[Any]]]:
    """Dotted name and array of everything in a tree of dataclasses, tuples, arrays, numbers, words and None."""
    if is_dataclass(value):
        for field in fields(value):
            if field.name != "meta":
                yield from _leaves(f"{name}.{field.name}", getattr(value, field.name))
    elif isinstance(value, list | tuple):
        for number, inner in enumerate(value):
            yield from _leaves(f"{name}.{number}", inner)
    elif value is None:
        yield name, np.array("none")
    else:
        array = np.asarray(value)
        if array.dtype.hasobject:  # its bytes would be addresses, other ones in each process
            raise TypeError(f"the body model's {name} is a {type(value).__name__}, of which no digest can be made")
        yield name, array


def _hand_model_digest() -> str:
    path = Path(__file__).resolve().parents[1] / "models" / "hands.npz"
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else "none"
