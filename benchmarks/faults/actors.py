"""Rendered operators standing where each mode begins, and what goes wrong with pictures."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Final

import numpy as np

from teleop.frames import Camera, DepthFrame, kinect_v1
from teleop.people.body import skin
from teleop.people.builtin import builtin_body
from teleop.people.clothes import dress
from teleop.people.motion import ArmKey, Key, Motion
from teleop.people.pose import pose_rig, unit
from teleop.people.room import greenhouse_room
from teleop.people.scene import Figure, shoot, stand
from teleop.people.sensor import sense
from teleop.people.shade import Light
from teleop.people.shape import Shape
from teleop.people.story import FIST, OPEN, arm, hanging
from teleop.people.view import sensor_view
from teleop.sources.virtual_options import SENSOR_HEIGHT_M, SENSOR_TILT_RAD, WORK_CLOTHES

CAMERA: Final = Camera(kinect_v1(320, 240))
VARIANTS: Final = 3
"""Pictures of each pose, each with its own sensor noise."""


_FRONT: Final = np.array([0.0, 0.0, -1.0])
HANGING: Final = (hanging(1), hanging(-1))


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """Where somebody stands [m] and how; apart: between the thighs [deg]."""

    x_m: float = 0.0
    z_m: float = 2.35
    right: ArmKey = HANGING[0]
    left: ArmKey = HANGING[1]
    apart_deg: float = 3.0
    second: tuple[float, float] | None = None
    """Somebody else beside, at (x, z)."""


REACH: Final = {"right": arm(1, 45, 5, 130, curl=OPEN), "left": arm(-1, 30, 5, 100, curl=OPEN)}
GRASP: Final = {"right": arm(1, 45, 5, 130, curl=FIST), "left": arm(-1, 30, 5, 100, curl=OPEN)}
CROSSED: Final = {
    side: ArmKey(unit(np.array([-0.1 * sign, -0.86, -0.5])), unit(np.array([-0.87 * sign, 0.4, -0.3])), _FRONT, FIST)
    for side, sign in (("right", 1.0), ("left", -1.0))
}
"""Forearms crossed before the chest."""
_ZONES: Final = {
    "picking": Pose(**REACH, apart_deg=24.0),
    "spraying": Pose(**REACH),
    "forward": Pose(z_m=1.66),
    "back": Pose(z_m=3.1),
    "left": Pose(x_m=-0.62),
    "right": Pose(x_m=0.62),
}
POSES: Final = {
    **_ZONES,
    **{f"{mode}, forearms crossed": replace(pose, **CROSSED) for mode, pose in _ZONES.items()},
    "spraying, fist": Pose(**GRASP),
    "forward, second person": Pose(z_m=1.66, second=(0.95, 2.9)),
    "picking, second person": Pose(**REACH, apart_deg=24.0, second=(1.0, 2.9)),
    "outside": Pose(x_m=1.25, z_m=3.0),
    "second person alone": Pose(x_m=0.95, z_m=2.9),
    "nobody": Pose(x_m=9.0, z_m=2.0),
}


@cache
def _people() -> tuple[tuple[object, object], tuple[object, object]]:
    first, second = (builtin_body(Shape(height, mass)) for height, mass in ((1.74, 72.0), (1.66, 60.0)))
    other = replace(WORK_CLOTHES, top_rgb=(150, 60, 50), trousers_rgb=(40, 60, 90))
    return (first, dress(first, WORK_CLOTHES, 1)), (second, dress(second, other, 2))


def _figure(who: int, pose: Pose, at: tuple[float, float]) -> Figure:
    body, worn = _people()[who]
    keys = [Key(t, *at, 0.0, pose.right, pose.left, float(np.radians(pose.apart_deg))) for t in (0.0, 10.0)]
    moment = Motion(keys, who).at(1.0)
    posed = pose_rig(body.rig, moment.pose)  # type: ignore[attr-defined]
    local = skin(body, posed, worn.vertices_m)  # type: ignore[arg-type, attr-defined]
    placed = stand(posed, local, *at, moment.turn)
    return Figure(body, worn, moment.pose, placed)  # type: ignore[arg-type]


@cache
def pictures(name: str) -> tuple[DepthFrame, ...]:
    """Depth and colour of a pose of POSES, rendered on first use."""
    pose = POSES[name]
    people = [_figure(0, pose, (pose.x_m, pose.z_m))]
    if name == "second person alone":
        people = [_figure(1, Pose(), (pose.x_m, pose.z_m))]
    if pose.second is not None:
        people.append(_figure(1, Pose(), pose.second))
    rng = np.random.default_rng(7)
    room, view = greenhouse_room(1), sensor_view(SENSOR_HEIGHT_M, SENSOR_TILT_RAD)
    shot = shoot(tuple(people), room, view, CAMERA, Light(), rng)
    return tuple(
        DepthFrame(0, sense(shot.depth_m, CAMERA, np.random.default_rng(i)).depth_mm, CAMERA, shot.color_rgb)
        for i in range(VARIANTS)
    )


def flat(value_mm: int) -> DepthFrame:
    """A picture with one reading everywhere: blank (0) or saturated."""
    return DepthFrame(0, np.full((240, 320), value_mm, np.uint16), CAMERA)
