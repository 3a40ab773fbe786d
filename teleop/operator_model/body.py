"""The operator's body: what it is asked to do, and how it gets there at the speed of a person."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from teleop.operator_model.reach import Reach, resting
from teleop.people.motion import ArmKey, Key, Moment, Walk, acted, sway_phases
from teleop.people.pose import unit
from teleop.people.rig import Floats

OPEN: Final = 0.03
FIST: Final = 1.0
"""Curl of an open hand and of a fist."""
_FRONT: Final = np.array([0.0, 0.0, -1.0])
_FOOT_S: Final = 0.35
"""A foot that is set apart, lifted and put down."""
_PEAK: Final = 1.875
"""Peak over mean speed of a minimum-jerk movement (Flash and Hogan 1985)."""


@dataclass(frozen=True, slots=True)
class ArmPosture:
    """An arm by the angles it is read by. side_deg, front_deg: theta1, theta2 of the upper arm; elbow_deg: theta3.

    swivel_deg: turn of the forearm about the upper arm, 0 forward and up, 90 outward; it is in none of the angles.
    """

    side_deg: float
    front_deg: float
    elbow_deg: float
    swivel_deg: float


@dataclass(frozen=True, slots=True)
class Posture:
    """A body: pelvis over (x, z) of the room [m], angle between the thighs, arms, hands 0 flat open .. 1 fist."""

    x_m: float
    z_m: float
    apart_deg: float
    right: ArmPosture
    left: ArmPosture
    right_curl: float
    left_curl: float


@dataclass(frozen=True, slots=True)
class Pace:
    """How fast somebody moves, and how exactly.

    arm_deg_s, walk_m_s: peak speeds of an unhurried reach and a step. hand_s: time to close or open a hand.
    least_s: no movement is shorter. miss: standard deviation of where a reach ends, as a part of its length, at least
    of 15 degrees (Fitts: the error grows with the distance).
    """

    arm_deg_s: float = 260.0
    walk_m_s: float = 1.0
    hand_s: float = 0.22
    least_s: float = 0.22
    miss: float = 0.05

    def step_s(self, way_m: float) -> float:
        """How long a step takes."""
        return max(self.least_s, _PEAK * way_m / self.walk_m_s)


def arm_key(arm: ArmPosture, sign: float, curl: float) -> ArmKey:
    """The directions of an arm; sign: +1 right, -1 left. The palm faces the sensor as far as the forearm lets it."""
    side, front = np.tan(np.radians([arm.side_deg, arm.front_deg]))
    upper = unit(np.array([sign * side, -1.0, -front]))
    # two directions across the upper arm
    outward = unit(np.cross(np.cross(upper, [sign, 0.0, 0.0]), upper))
    ahead = sign * np.cross(outward, upper)
    turn, fold = np.radians([arm.swivel_deg, 180.0 - arm.elbow_deg])
    fore = np.cos(fold) * upper + np.sin(fold) * (np.cos(turn) * ahead + np.sin(turn) * outward)
    return ArmKey(upper, unit(fore), _FRONT, curl)


def _arm(a: ArmPosture) -> Floats:
    return np.array([a.side_deg, a.front_deg, a.elbow_deg, a.swivel_deg])


def _goals(p: Posture) -> dict[str, Floats]:
    """Every part of the body that moves on its own."""
    return {
        "place": np.array([p.x_m, p.z_m]),
        "legs": np.array([p.apart_deg]),
        "right": _arm(p.right),
        "left": _arm(p.left),
        "right_hand": np.array([p.right_curl]),
        "left_hand": np.array([p.left_curl]),
    }


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """Where every part of the body is bound for. asked: the last posture. walked_m: the way walked until seen_s."""

    asked: Posture
    pace: Pace
    seed: int
    parts: dict[str, Reach]
    phase: Floats
    walked_m: float = 0.0
    seen_s: float = 0.0
    reaches: int = 0

    def ask(self, posture: Posture, t_s: float) -> Body:
        """Begin, at a time, to move those parts whose goal has changed."""
        before, wanted = _goals(self.asked), _goals(posture)
        parts, reaches = dict(self.parts), self.reaches
        for name, goal in wanted.items():
            if np.array_equal(goal, before[name]):
                continue
            reaches += 1
            rng = np.random.default_rng([self.seed, reaches])
            at = parts[name].at(t_s)[0]
            parts[name] = parts[name].towards(self._aimed(name, at, goal, rng), t_s, self._lasts_s(name, at, goal))
        return replace(self, asked=posture, parts=parts, reaches=reaches)

    def at(self, t_s: float) -> tuple[Moment, Body]:
        """The person at a time, not before the last one asked for, and the body that has walked until then."""
        place, velocity, _ = self.parts["place"].at(t_s)
        step = np.hypot(*(place - self.parts["place"].at(self.seen_s)[0]))
        after = replace(self, walked_m=self.walked_m + float(step), seen_s=t_s)
        key = Key(
            t_s=t_s,
            x_m=float(place[0]),
            z_m=float(place[1]),
            turn_rad=0.0,
            right=self._arm_at("right", 1.0, t_s),
            left=self._arm_at("left", -1.0, t_s),
            apart_rad=float(np.radians(self.parts["legs"].at(t_s)[0][0])),
        )
        walk = Walk((float(velocity[0]), float(velocity[1])), float(np.hypot(*velocity)), after.walked_m)
        return acted(key, walk, self.phase), after

    def done(self, name: str, t_s: float) -> bool:
        """Whether a part has come to rest, as its owner feels."""
        return t_s >= self.parts[name].end_s

    def _arm_at(self, side: str, sign: float, t_s: float) -> ArmKey:
        angles = self.parts[side].at(t_s)[0]
        curl = float(np.clip(self.parts[f"{side}_hand"].at(t_s)[0][0], 0.0, 1.0))
        return arm_key(ArmPosture(*(float(a) for a in angles)), sign, curl)

    def _lasts_s(self, name: str, at: Floats, goal: Floats) -> float:
        if name.endswith("hand"):
            return self.pace.hand_s
        if name == "place":
            return self.pace.step_s(float(np.hypot(*(goal - at))))
        least = _FOOT_S if name == "legs" else self.pace.least_s
        return max(least, _PEAK * float(np.abs(goal - at).max()) / self.pace.arm_deg_s)

    def _aimed(self, name: str, at: Floats, goal: Floats, rng: np.random.Generator) -> Floats:
        """Where a movement really ends."""
        if name not in ("right", "left"):
            return goal
        spread = self.pace.miss * max(15.0, float(np.abs(goal - at).max()))
        return np.asarray(goal + rng.normal(0.0, spread, len(goal)))


def standing(posture: Posture, pace: Pace, seed: int) -> Body:
    """A body at rest in a posture."""
    parts = {name: resting(goal) for name, goal in _goals(posture).items()}
    return Body(posture, pace, seed, parts, sway_phases(seed))
