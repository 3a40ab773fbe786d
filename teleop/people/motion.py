"""Motion through key poses: minimum-jerk transitions, walking legs, slight sway. A pure function of time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from teleop.people.pose import DOWN, FORWARD, ArmPose, LegPose, Pose, rotation, unit, yaw
from teleop.people.rig import Floats

_STEP_M: Final = 0.55
_SWING_RAD: Final = 0.38
"""Half the thigh's swing in unhurried walking (Winter 1991: about 40 degrees from end to end)."""


@dataclass(frozen=True, slots=True, eq=False)
class ArmKey:
    """An arm in a key pose: directions (3,) of upper arm, forearm and palm; curl 0 open .. 1 fist."""

    upper: Floats
    fore: Floats
    palm: Floats
    curl: float


@dataclass(frozen=True, slots=True, eq=False)
class Key:
    """Where the operator is at a time: pelvis over (x, z) of the room, turn, arms, angle between the thighs."""

    t_s: float
    x_m: float
    z_m: float
    turn_rad: float
    right: ArmKey
    left: ArmKey
    apart_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """The operator at one instant: pose, place in the room, turn (3, 3), and the hands' curl (right, left)."""

    pose: Pose
    x_m: float
    z_m: float
    turn: Floats
    curl: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Walk:
    """Which way (x, z; any length) and how fast somebody walks, and how far they have walked altogether."""

    way_m: tuple[float, float] = (0.0, 0.0)
    speed_m_s: float = 0.0
    walked_m: float = 0.0


def minimum_jerk(u: float) -> tuple[float, float]:
    """Position and velocity, over unit time and distance, of the smoothest reach (Flash and Hogan 1985, eq. 3)."""
    u = min(1.0, max(0.0, u))
    return u**3 * (10 + u * (6 * u - 15)), 30 * u**2 * (1 - u) ** 2


def turned(a: Floats, b: Floats, s: float) -> Floats:
    """The direction at fraction s of the way from a to b along the great circle."""
    angle = float(np.arccos(np.clip(a @ b, -1.0, 1.0)))
    if angle < 1e-4:
        return a
    return unit((np.sin((1 - s) * angle) * a + np.sin(s * angle) * b) / np.sin(angle))


def _mix_arm(a: ArmKey, b: ArmKey, s: float) -> ArmKey:
    palm = turned(a.palm, b.palm, s)
    return ArmKey(turned(a.upper, b.upper, s), turned(a.fore, b.fore, s), palm, (1 - s) * a.curl + s * b.curl)


def _legs(apart: float, swing: float, lift: tuple[float, float], along: Floats) -> tuple[LegPose, LegPose]:
    """Legs apart to the sides, swung along the walk (one ahead, one behind), knees lifted in turn."""
    legs = []
    for sign, raised in ((1.0, lift[0]), (-1.0, lift[1])):
        side = np.array([sign * np.tan(apart / 2), 0.0, 0.0])
        leg = np.array(DOWN) + side + np.tan(sign * swing) * along
        thigh = unit(leg + np.tan(0.5 * raised) * np.array(FORWARD))
        shin = unit(leg - np.tan(0.6 * raised) * np.array(FORWARD))
        legs.append(LegPose(thigh, shin, yaw(-sign * 0.12) @ np.array(FORWARD)))
    return legs[0], legs[1]


class Motion:
    """A sequence of key poses in order of time."""

    def __init__(self, keys: Sequence[Key], seed: int = 0) -> None:
        """keys: at least two. seed: phases of the sway."""
        self.keys = tuple(keys)
        self._times = np.array([k.t_s for k in keys])
        steps = [np.hypot(b.x_m - a.x_m, b.z_m - a.z_m) for a, b in pairwise(keys)]
        self._walked_m = np.concatenate([[0.0], np.cumsum(steps)])
        self._phase = sway_phases(seed)

    @property
    def duration_s(self) -> float:
        """Time of the last key."""
        return float(self._times[-1])

    def at(self, t_s: float) -> Moment:
        """The operator at a time (before the first and after the last key they stand still)."""
        i = int(np.clip(np.searchsorted(self._times, t_s, side="right") - 1, 0, len(self.keys) - 2))
        a, b = self.keys[i], self.keys[i + 1]
        s, rate = minimum_jerk((t_s - a.t_s) / (b.t_s - a.t_s))
        dx, dz = b.x_m - a.x_m, b.z_m - a.z_m
        distance = float(np.hypot(dx, dz))
        key = Key(
            t_s,
            a.x_m + s * dx,
            a.z_m + s * dz,
            (1 - s) * a.turn_rad + s * b.turn_rad,
            _mix_arm(a.right, b.right, s),
            _mix_arm(a.left, b.left, s),
            (1 - s) * a.apart_rad + s * b.apart_rad,
        )
        walk = Walk((dx, dz), distance * rate / (b.t_s - a.t_s), self._walked_m[i] + s * distance)
        return acted(key, walk, self._phase)


def sway_phases(seed: int) -> Floats:
    """Phases (8,) of the sway of chest, head, place and hands [rad]."""
    return np.random.default_rng(seed).uniform(0, 2 * np.pi, 8)


def acted(key: Key, walk: Walk, phase: Floats) -> Moment:
    """The body in a key pose while it walks, swaying slightly; phase: of :func:`sway_phases`."""
    dx, dz = walk.way_m
    distance = float(np.hypot(dx, dz))
    turn = yaw(key.turn_rad)
    along = turn.T @ np.array([dx, 0.0, dz]) / distance if distance > 1e-6 else np.array(FORWARD)
    stride = np.pi * walk.walked_m / _STEP_M
    vigour = min(1.0, walk.speed_m_s / 0.6)
    # Sideways the legs open and close but do not cross.
    swing = _SWING_RAD * vigour * float(np.sin(stride)) * (1.0 - 0.6 * abs(float(along[0])))
    lift = tuple(vigour * 0.75 * max(0.0, sign * float(np.cos(stride))) for sign in (1.0, -1.0))
    legs = _legs(key.apart_rad, swing, (lift[0], lift[1]), along)
    sway = 0.012 * np.sin(2 * np.pi * np.array([0.31, 0.23, 0.37, 0.29, 0.9, 1.1, 0.8, 1.3]) * key.t_s + phase)
    chest = rotation(np.array([1.0, 0.0, 0.0]), float(sway[0])) @ yaw(float(sway[1]) - 0.25 * swing)
    head = chest @ yaw(-0.6 * key.turn_rad + float(sway[2]))
    arms = []
    for k, arm in enumerate((key.right, key.left)):
        shake = np.array([sway[4 + k], sway[6 + k], -0.6 * (1.0 - 2.0 * k) * swing * max(0.0, -arm.upper[1]) ** 4])
        arms.append(
            ArmPose(unit(arm.upper + shake), unit(arm.fore + shake), palm=arm.palm, curl=arm.curl, spread_rad=0.1)
        )
    pose = Pose((arms[0], arms[1]), legs, yaw(0.2 * swing), chest, head)
    return Moment(pose, key.x_m + 0.4 * float(sway[3]), key.z_m, turn, (key.right.curl, key.left.curl))
