"""A person of 20 joints whose arms, legs and place are given, and frames to go with it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, radians, sin

import numpy as np
import numpy.typing as npt

from teleop.frames import Camera, DepthFrame, kinect_v1
from teleop.intent_types import Hand, Hands
from teleop.joints import JOINT_INDEX, JOINT_NAMES
from teleop.skeleton import Skeleton, Track

UPPER_ARM_M, FOREARM_M, HAND_M, THIGH_M, SHIN_M = 0.30, 0.26, 0.09, 0.42, 0.40


@dataclass(frozen=True)
class Arm:
    """Unit vectors (forward, outward, up) of upper arm and forearm."""

    upper: tuple[float, float, float] = (0.0, 0.0, -1.0)
    fore: tuple[float, float, float] = (0.0, 0.0, -1.0)


NO_HANDS = Hands()
HANGING = Arm()
OPEN_HANDS = Hands(Hand.OPEN, Hand.OPEN, 1.0, 1.0)
FISTS = Hands(Hand.FIST, Hand.FIST, 1.0, 1.0)
BESIDE_HEAD = Arm((0.0, sin(radians(60)), -cos(radians(60))), (0.1, 0.2, 0.97))
"""One arm of the engage gesture."""
CROSSED = Arm((0.5, -0.1, -0.86), (0.3, -0.87, 0.4))
"""One arm of the body stop."""


def raised(outward_deg: float = 0.0, forward_deg: float = 0.0) -> Arm:
    """A straight arm raised in one of the two planes."""
    if forward_deg:
        d = (sin(radians(forward_deg)), 0.0, -cos(radians(forward_deg)))
    else:
        d = (0.0, sin(radians(outward_deg)), -cos(radians(outward_deg)))
    return Arm(d, d)


@dataclass(frozen=True)
class Person:
    """Where somebody stands [m, levelled], facing the sensor, and how."""

    x: float = 0.0
    z: float = 2.3
    right: Arm = HANGING
    left: Arm = HANGING
    legs_apart_deg: float = 0.0
    stride_deg: float = 0.0
    hands: Hands = NO_HANDS

    def but(self, **changes: object) -> Person:
        """The same person with some things changed."""
        return replace(self, **changes)  # type: ignore[arg-type]


def joints(person: Person) -> npt.NDArray[np.float64]:
    """(20, 3) joints in metres; a level sensor 1 m above the floor."""
    p: dict[str, npt.NDArray[np.float64]] = {}
    centre = np.array([person.x, 0.0, person.z])
    p["hip_center"] = centre + np.array((0, 0.05, 0))
    p["spine"] = centre + np.array((0, 0.15, 0))
    p["shoulder_center"] = centre + np.array((0, 0.52, 0))
    p["head"] = centre + np.array((0, 0.70, 0))
    for side, out, arm, leg_sign in (("right", 1.0, person.right, 1.0), ("left", -1.0, person.left, -1.0)):

        def vector(fou: tuple[float, float, float], out: float = out) -> npt.NDArray[np.float64]:
            v = np.array([out * fou[1], fou[2], -fou[0]])
            return v / np.linalg.norm(v)

        p[f"shoulder_{side}"] = centre + np.array((0.18 * out, 0.46, 0))
        p[f"elbow_{side}"] = p[f"shoulder_{side}"] + UPPER_ARM_M * vector(arm.upper)
        p[f"wrist_{side}"] = p[f"elbow_{side}"] + FOREARM_M * vector(arm.fore)
        p[f"hand_{side}"] = p[f"wrist_{side}"] + HAND_M * vector(arm.fore)
        apart, stride = radians(person.legs_apart_deg / 2), leg_sign * radians(person.stride_deg / 2)
        leg = np.array([out * np.tan(apart), -1.0, np.tan(stride)])
        leg /= np.linalg.norm(leg)
        p[f"hip_{side}"] = centre + np.array((0.09 * out, -0.05, 0))
        p[f"knee_{side}"] = p[f"hip_{side}"] + THIGH_M * leg
        p[f"ankle_{side}"] = p[f"knee_{side}"] + SHIN_M * leg
        p[f"foot_{side}"] = p[f"ankle_{side}"] + np.array((0, -0.05, -0.15))
    return np.array([p[name] for name in JOINT_NAMES])


def skeleton(person: Person, t_ns: int = 0, rng: np.random.Generator | None = None, rms_mm: float = 20.0) -> Skeleton:
    """A skeleton with full confidence; with a generator, with white 3-D noise of the given RMS."""
    points = joints(person)
    if rng is not None:
        points = points + rng.normal(0.0, rms_mm * 1e-3 / np.sqrt(3), points.shape)
    return Skeleton(t_ns, points, np.ones(len(JOINT_NAMES)))


def track(person: Person | None, t_ns: int, reset: bool = False, rng: np.random.Generator | None = None) -> Track:
    """A track of that person, or of nobody."""
    body = None if person is None else skeleton(person, t_ns, rng)
    return Track(t_ns, body, None, None, None, None, reset)


CAMERA = Camera(depth=kinect_v1(160, 120))


def frame(t_ns: int, seq: int = 0) -> DepthFrame:
    """A depth frame whose picture does not matter: a slope without a person, one reading of noise by its number."""
    depth = np.tile(np.linspace(3000, 4000, 160).astype(np.uint16), (120, 1))
    depth[0, 0] += seq % 7
    return DepthFrame(t_ns, depth, CAMERA, None, seq)


def without(body: Skeleton, *names: str) -> Skeleton:
    """The same skeleton with some joints unknown."""
    points = body.joints_m.copy()
    points[[JOINT_INDEX[name] for name in names]] = np.nan
    return Skeleton(body.t_ns, points, body.confidence)
