"""A virtual operator's script: a TOML file of steps, each with its seconds and what changes from the step before.

[[step]]
seconds = 2.0          # how long the step lasts
z_m = 2.35             # place, turn and legs: x_m, z_m, turn_deg, apart_deg
gesture = "engage"     # none, engage (hands beside the head), stop (forearms crossed)
right = { side_deg = 60, front_deg = 0, elbow_deg = 120, hand = "open" }   # open, relaxed, fist; left alike
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from teleop.errors import SourceError
from teleop.frames import Camera
from teleop.people.performance import Stage, Take
from teleop.people.puppet import Puppet
from teleop.people.wishes import Wish, WishChange

_LONGEST_S = 3600.0


class _Step(WishChange):
    seconds: float = Field(gt=0.0, le=600.0, description="how long the step lasts [s]")


class _Script(BaseModel):
    model_config = ConfigDict(extra="forbid")
    step: Annotated[list[_Step], Field(min_length=1, max_length=10_000)]


@dataclass(frozen=True, slots=True)
class Scene:
    """From the end of the scene before on: what the operator does, for so long [s]."""

    seconds: float
    wish: Wish


def read_script(path: Path) -> tuple[Scene, ...]:
    """The scenes of a script. Raises SourceError, one line that names step and value."""
    try:
        tree = tomllib.loads(path.read_text(encoding="utf-8"))
        steps = _Script.model_validate(tree).step
    except (OSError, UnicodeDecodeError) as error:
        why = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise SourceError(f"cannot read the script {path}: {why}") from None
    except tomllib.TOMLDecodeError as error:
        raise SourceError(f"{path} is no TOML file: {error}") from None
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(str(part) for part in first["loc"])
        raise SourceError(f"{path}: {where}: {first['msg']}; steps hold {', '.join(_Step.model_fields)}") from None
    if (total_s := sum(step.seconds for step in steps)) > _LONGEST_S:
        raise SourceError(f"{path} lasts {total_s:.0f} s; a script may last {_LONGEST_S:.0f} s")
    wish, scenes = Wish(), []
    for step in steps:
        wish = WishChange.model_validate(step.model_dump(exclude={"seconds"})).of(wish)
        scenes.append(Scene(step.seconds, wish))
    return tuple(scenes)


class ScriptedPerformance:
    """A script acted on a stage. Any frame can be asked for; those before it are walked through, not rendered."""

    def __init__(self, stage: Stage, scenes: tuple[Scene, ...], frames_per_s: float) -> None:
        self.frames_per_s = frames_per_s
        self._stage = stage
        self._scenes = scenes
        self._begin()

    @property
    def camera(self) -> Camera:
        """The sensor's."""
        return self._stage.camera

    @property
    def frame_count(self) -> int:
        """Frames from the begin of the first scene to the end of the last."""
        return int(sum(scene.seconds for scene in self._scenes) * self.frames_per_s + 1e-9) + 1

    def take(self, number: int) -> Take:
        """Frame ``number``; deterministic."""
        if number < self._next:
            self._begin()
        while self._next <= number:
            t_s = self._next / self.frames_per_s
            self._moment = self._puppet.step(self._wish(t_s), 1.0 / self.frames_per_s)
            self._next += 1
        return self._stage.take(self._moment, number, round(number / self.frames_per_s * 1e9))

    def _begin(self) -> None:
        self._puppet = Puppet(self._scenes[0].wish, self._stage.seed)
        self._next = 0

    def _wish(self, t_s: float) -> Wish:
        end_s = 0.0
        for scene in self._scenes:
            end_s += scene.seconds
            if t_s < end_s:
                return scene.wish
        return self._scenes[-1].wish
