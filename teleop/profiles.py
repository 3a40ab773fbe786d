"""Operator profiles: one JSON file per person, found by name, and learned from a session."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import numpy as np
from pydantic import ValidationError

from teleop.config import OperatorConfig
from teleop.config.operator import BONES, NAME_PATTERN
from teleop.errors import TeleopError
from teleop.hands.skin_model import SkinModel
from teleop.joints import JOINT_INDEX
from teleop.skeleton import Skeleton


class ProfileError(TeleopError):
    """A profile that does not exist, cannot be read or written, or is not legal."""


_ENDS: Final = {
    "upper_arm": ("shoulder", "elbow"),
    "forearm": ("elbow", "wrist"),
    "thigh": ("hip", "knee"),
    "shin": ("knee", "ankle"),
}
_SURE: Final = 0.3
_FEWEST_FRAMES: Final = 15


@dataclass(frozen=True, slots=True)
class ProfileStore:
    """Profiles in a folder; names are compared without regard to case."""

    folder: Path

    def names(self) -> list[str]:
        """All names, sorted."""
        if not self.folder.is_dir():
            return []
        return sorted((self._name(path) for path in self.folder.glob("*.json")), key=str.casefold)

    def load(self, name: str) -> OperatorConfig:
        """The profile of that name. Raises ProfileError with the names there are."""
        path = self._path(name)
        if not path.is_file():
            known = ", ".join(self.names()) or "none yet"
            raise ProfileError(f"no operator '{name}'; known: {known}; 'teleop operators learn NAME SESSION' makes one")
        return self._read(path)

    def save(self, profile: OperatorConfig) -> None:
        """Write a profile under its name, whole or not at all. Raises ProfileError."""
        path = self._path(profile.name)
        part = path.with_suffix(".part")
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            part.write_text(json.dumps(profile.model_dump(mode="json"), indent=1) + "\n", encoding="utf-8")
            part.replace(path)
        except OSError as error:
            raise ProfileError(f"cannot write {path}: {error.strerror}; set another folder in 'operators'") from error

    def remove(self, name: str) -> None:
        """Forget somebody. Raises ProfileError when the name is unknown."""
        self.load(name)
        self._path(name).unlink()

    def _path(self, name: str) -> Path:
        if not name or not re.match(NAME_PATTERN, name):
            raise ProfileError(
                f"'{name}' is no name for an operator; legal: up to 40 letters, digits, blanks, '.', '_', '-'"
            )
        return self.folder / f"{name.casefold().replace(' ', '_')}.json"

    def _name(self, path: Path) -> str:
        try:
            return self._read(path).name
        except ProfileError:
            return path.stem

    def _read(self, path: Path) -> OperatorConfig:
        try:
            return OperatorConfig.model_validate_json(path.read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError) as error:
            raise ProfileError(
                f"profile {path} cannot be read ({error}); remove the file and learn it again"
            ) from error
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            where = ".".join(str(part) for part in first["loc"]) or "profile"
            raise ProfileError(
                f"profile {path} is not legal: {where}: {first['msg']}; correct it, or remove it and learn it again"
            ) from error


def bone_lengths_m(skeletons: Iterable[Skeleton]) -> dict[str, float]:
    """Median length of each bone over many frames, both sides together; bones seen in too few frames are left out."""
    found: dict[str, list[float]] = {bone: [] for bone in BONES}
    for body in skeletons:
        for bone, (a, b) in _ENDS.items():
            for side in ("right", "left"):
                _add(found[bone], body, f"{a}_{side}", f"{b}_{side}")
        _add(found["trunk"], body, "hip_center", "shoulder_center")
    return {bone: round(float(np.median(ls)), 3) for bone, ls in found.items() if len(ls) >= _FEWEST_FRAMES}


def _add(lengths: list[float], body: Skeleton, a: str, b: str) -> None:
    p, q = body.joint(a), body.joint(b)
    if p is None or q is None or min(body.confidence[[JOINT_INDEX[a], JOINT_INDEX[b]]]) < _SURE:
        return
    lengths.append(float(np.linalg.norm(p - q)))


def learned_profile(
    name: str, skeletons: Iterable[Skeleton], skin: SkinModel | None, handedness: Literal["right", "left"] | None
) -> OperatorConfig:
    """A profile from what a session showed. Raises ProfileError when it showed too little of a person."""
    bones_m = bone_lengths_m(skeletons)
    if not bones_m:
        raise ProfileError(
            f"too little of a person was seen to learn '{name}'; stand 2 to 3 m before the sensor for some seconds"
        )
    values = None if skin is None else tuple(round(v, 3) for v in (*skin.mean, *skin.covariance))
    try:
        return OperatorConfig.model_validate(
            {"name": name, "handedness": handedness, "bones_m": bones_m, "skin": values}
        )
    except ValidationError as error:
        raise ProfileError(f"'{name}': {error.errors(include_url=False)[0]['msg']}") from error
