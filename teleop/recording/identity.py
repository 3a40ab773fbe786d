"""What a recording was made with, so that a replay knows whether it may expect the very same bits."""

from __future__ import annotations

import hashlib
import platform
from dataclasses import fields
from importlib.metadata import PackageNotFoundError, version
from typing import Final

import numpy as np
from llvmlite import binding

from teleop.body.model import BodyModel
from teleop.recording import topics
from teleop.software import software_version, sources_digest

KEY_SOURCES: Final = "sources_sha256"
KEY_LIBRARIES: Final = "libraries"
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
    for field in fields(model):
        if field.name == "meta":
            continue
        value = np.asarray(getattr(model, field.name))
        digest.update(f"{field.name} {value.dtype.str} {value.shape}\n".encode())
        digest.update(np.ascontiguousarray(value).tobytes())
    return digest.hexdigest()
