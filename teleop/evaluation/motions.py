"""Free arm motion: people who move both arms all the time, minimum-jerk reaches through random key poses."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from teleop.evaluation.cases import Case, Person, placed, shot, unseen_person
from teleop.evaluation.poses import free_directions
from teleop.frames import Camera, kinect_v1
from teleop.people.motion import ArmKey, Key, Motion
from teleop.people.pose import ArmPose, LegPose, Pose, pose_rig
from teleop.people.rig import arms_in_trunk
from teleop.people.room import random_room
from teleop.people.shade import Light
from teleop.people.view import sensor_view

_FRONT = np.array([0.0, 0.0, -1.0])


@dataclass(frozen=True, slots=True)
class FreeMotion:
    """One batch is one person moving freely.

    frames: how many. fps: of the sensor. reach_s: a reach from key to key lasts from, to. color: with colour images.
    The motion does not depend on fps. room: a random room, else cut out.
    """

    frames: int = 90
    fps: float = 30.0
    reach_s: tuple[float, float] = (0.7, 1.3)
    width: int = 640
    height: int = 480
    mirrored: bool = False
    room: bool = True
    color: bool = False

    def batch(self, index: int) -> list[Case]:
        """The frames of person ``index``. Raises DataError without the MakeHuman files."""
        rng = np.random.default_rng([53, index])
        person = unseen_person(200 + index)
        x, z = float(rng.uniform(-0.2, 0.2)), float(rng.uniform(2.0, 2.6))
        motion = free_motion(person, rng, x, z, self.frames / self.fps, self.reach_s)
        view = sensor_view(float(rng.uniform(0.9, 1.2)), np.radians(rng.uniform(-4, 2)))
        camera = Camera(kinect_v1(self.width, self.height), self.mirrored)
        room = random_room(rng, np.array([x, 0.0, z])) if self.room else None
        light = Light(level=1.0) if self.color else None
        out = []
        for n in range(self.frames):
            t_s = n / self.fps
            moment = motion.at(t_s)
            figure = placed(person, moment.pose, moment.x_m, moment.z_m, moment.turn)
            case = shot((figure,), room, view, camera, np.random.default_rng([53, index, n]), light)
            out.append(replace(case, frame=replace(case.frame, t_ns=round(t_s * 1e9), seq=n), group=index))
        return out


def free_motion(
    person: Person, rng: np.random.Generator, x_m: float, z_m: float, seconds: float, reach_s: tuple[float, float]
) -> Motion:
    """Key poses of free arms, feet in place, legs opening and closing; no hand runs through the trunk."""
    keys: list[Key] = []
    t, turn, apart = 0.0, float(rng.normal(0, 0.1)), float(rng.uniform(0.0, 0.45))
    while not keys or keys[-1].t_s < seconds + 0.1:
        for _ in range(30):
            key = Key(t, x_m, z_m, turn, _arm_key(rng, 1.0), _arm_key(rng, -1.0), apart)
            if _clear(person, [*keys[-1:], key]):
                break
        keys.append(key)
        t += float(rng.uniform(*reach_s))
        turn, apart = turn + float(rng.normal(0, 0.05)), float(np.clip(apart + rng.normal(0, 0.08), 0.0, 0.5))
    return Motion(keys, int(rng.integers(2**31)))


def _arm_key(rng: np.random.Generator, sign: float) -> ArmKey:
    upper, fore = free_directions(rng, sign)
    palm = _FRONT + rng.normal(0, 0.5, 3)
    return ArmKey(upper, fore, palm / np.linalg.norm(palm), float(rng.choice([0.05, 0.3, 1.0])))


def _clear(person: Person, keys: list[Key]) -> bool:
    """Whether no arm lies in the trunk at the last key and on the way there."""
    if len(keys) == 1:
        k = keys[0]
        arms = tuple(ArmPose(a.upper, a.fore, palm=a.palm) for a in (k.right, k.left))
        return not arms_in_trunk(
            person.body.rig, pose_rig(person.body.rig, Pose((arms[0], arms[1]), (LegPose(), LegPose())))
        )
    motion = Motion(keys)
    times = np.linspace(keys[0].t_s, keys[1].t_s, 6)[1:]
    rig = person.body.rig
    return not any(arms_in_trunk(rig, pose_rig(rig, motion.at(float(t)).pose)) for t in times)
