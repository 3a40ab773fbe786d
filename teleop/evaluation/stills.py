"""Single frames of posed people: one setting of sensor, room and person at a time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from teleop.evaluation.cases import Case, Person, dressed, placed, shot, unseen_person, with_dropout
from teleop.evaluation.objects import KINDS
from teleop.evaluation.poses import PROTOCOL, Kind, pose_of
from teleop.frames import Camera, kinect_v1
from teleop.people.pose import Pose, yaw
from teleop.people.room import furnished, random_room
from teleop.people.shape import Shape
from teleop.people.view import sensor_view

BATCH = 10
"""Frames of one person, rendered and kept together."""
TESTERS = 10


@dataclass(frozen=True, slots=True)
class Stills:
    """Random people of the evaluation in poses of a kind; every one of ``BATCH`` frames is of the same person.

    levels: degrees, taken in turn; empty: the kind has none. distance_m, height_m, tilt_deg, turn_deg: from, to.
    room: a random room, else cut out. behind: a second person. furniture: something within arm's reach.
    dropout: share of pixels lost. The same index and kind give the same people and poses in every setting.
    """

    kind: Kind = "free"
    levels: tuple[float, ...] = ()
    width: int = 640
    height: int = 480
    mirrored: bool = False
    distance_m: tuple[float, float] = (2.0, 2.7)
    height_m: tuple[float, float] = (0.9, 1.1)
    tilt_deg: tuple[float, float] = (-3.0, 3.0)
    turn_deg: float = 12.0
    room: bool = True
    behind: bool = False
    furniture: bool = False
    dropout: float = 0.0

    def batch(self, index: int) -> list[Case]:
        """Frames ``BATCH * index`` and on. Raises DataError without the MakeHuman files."""
        person = unseen_person(index)
        return [self._case(person, index, BATCH * index + n) for n in range(BATCH)]

    def _case(self, person: Person, index: int, number: int) -> Case:
        level = self.levels[number % len(self.levels)] if self.levels else float("nan")
        pose = pose_of(np.random.default_rng([41, number]), self.kind, level)
        case = stage(self, person, pose, np.random.default_rng([43, number]), index)
        return replace(case, level=level)


def stage(setting: Stills, person: Person, pose: Pose, rng: np.random.Generator, index: int) -> Case:
    """A pose before the sensor of a setting."""
    draw = rng.uniform(0, 1, 5)
    z = _between(setting.distance_m, draw[0])
    x = (2 * draw[1] - 1) * min(0.35, 0.15 * z)
    view = sensor_view(_between(setting.height_m, draw[2]), np.radians(_between(setting.tilt_deg, draw[3])))
    camera = Camera(kinect_v1(setting.width, setting.height), setting.mirrored)
    figures = [placed(person, pose, x, z, yaw(np.radians(setting.turn_deg) * (2 * draw[4] - 1)))]
    room = random_room(rng, np.array([x, 0.0, z])) if setting.room else None
    if setting.behind:
        aside, beyond = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.25, 0.8)), float(rng.uniform(0.6, 1.3))
        other = pose_of(rng, "free", 0.0)
        figures.append(placed(unseen_person(500 + index), other, x + aside, z + beyond, yaw(rng.uniform(-0.5, 0.5))))
    if setting.furniture and room is not None:
        names = sorted(KINDS)
        mesh = KINDS[names[int(rng.integers(len(names)))]](rng)
        side = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.45, 0.75))
        room = furnished(room, mesh, x + side, z + float(rng.uniform(-0.2, 0.35)), float(rng.uniform(0, 6.28)))
    case = replace(shot(tuple(figures), room, view, camera, rng), group=index)
    return with_dropout(case, setting.dropout, rng) if setting.dropout > 0 else case


def _between(ends: tuple[float, float], share: float) -> float:
    return float(ends[0] + share * (ends[1] - ends[0]))


@dataclass(frozen=True, slots=True)
class Testers:
    """The source's experiment (section 4.2): ten people of 165-190 cm and 45-90 kg, each at every level of a movement.

    One batch is one tester; both arms do the same.
    """

    kind: Literal["forward", "sideways", "elbow_forward", "elbow_across"]
    setting: Stills = Stills(distance_m=(2.2, 2.4), height_m=(1.0, 1.0), tilt_deg=(0.0, 0.0), turn_deg=4.0)
    repeats: int = 1

    def batch(self, index: int) -> list[Case]:
        """All levels of tester ``index``; from 10 on other people of the same ten sizes."""
        person, out = tester(index), []
        for repeat in range(self.repeats):
            for n, level in enumerate(PROTOCOL[self.kind]):
                seed = [47, index, n, repeat]
                pose = pose_of(np.random.default_rng([*seed, 0]), self.kind, level)
                case = stage(self.setting, person, pose, np.random.default_rng([*seed, 1]), index)
                out.append(replace(case, level=level))
        return out


def tester(index: int) -> Person:
    """Every ten: heights spread evenly over 165-190 cm, masses over 45-90 kg, the tall heavier on the whole."""
    rng = np.random.default_rng([48, index])
    height, mass = tester_size(index)
    descent = rng.dirichlet((0.7, 0.7, 0.7))
    shape = Shape(height, mass, float(index % 2), float(rng.uniform(0, 0.3)), float(rng.uniform(0.3, 0.7)),
                  (float(descent[0]), float(descent[1]), float(descent[2])))  # fmt: skip
    return dressed(shape, rng)


def tester_size(index: int) -> tuple[float, float]:
    """Height [m] and mass [kg] of tester ``index``."""
    size = index % TESTERS
    heavier = (0, 2, 1, 4, 3, 6, 5, 8, 7, 9)[size]
    return 1.65 + 0.25 * size / (TESTERS - 1), 45.0 + 45.0 * heavier / (TESTERS - 1)
