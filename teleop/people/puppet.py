"""A rendered operator who is told where to be and how to hold the limbs, and gets there as a person would. Pure."""

from __future__ import annotations

from dataclasses import replace
from math import exp, hypot, radians
from typing import Final

import numpy as np

from teleop.people.motion import ArmKey, Key, Moment, Walk, acted, sway_phases, turned
from teleop.people.pose import unit
from teleop.people.rig import Floats
from teleop.people.story import FIST, OPEN, RELAXED, arm, beside_head, hanging
from teleop.people.wishes import ArmWish, Hand, Wish

_CURL: Final[dict[Hand, float]] = {"open": OPEN, "relaxed": RELAXED, "fist": FIST}
_FRONT: Final = np.array([0.0, 0.0, -1.0])
_HANGING_DEG: Final = 8.0
"""Upper arms raised less than this, and not bent, hang as arms at rest do."""
_WALK_M_S: Final = 0.8
_TURN_RAD_S: Final = 2.0
_LIMB_RAD_S: Final = 2.6
"""Unhurried speeds of a person: walking, turning, an arm or a leg."""
_CURL_PER_S: Final = 4.0
_EASE_S: Final = 0.12
"""Time in which the rest of a way is eased out."""


class Puppet:
    """Follows a wish, step by step; the same wishes and steps give the same motion. seed: of the sway."""

    def __init__(self, wish: Wish | None = None, seed: int = 0) -> None:
        self._key = key_of(wish or Wish(), 0.0)
        self._walked_m = 0.0
        self._phase = sway_phases(seed)

    def step(self, wish: Wish, dt_s: float) -> Moment:
        """Go on for ``dt_s`` seconds [s] towards the wish."""
        now, goal = self._key, key_of(wish, 0.0)
        dx, dz = goal.x_m - now.x_m, goal.z_m - now.z_m
        distance = hypot(dx, dz)
        step = _step(distance, _WALK_M_S, dt_s)
        share = step / distance if distance > 1e-9 else 0.0
        self._walked_m += step
        self._key = Key(
            now.t_s + dt_s,
            now.x_m + share * dx,
            now.z_m + share * dz,
            now.turn_rad + _step(goal.turn_rad - now.turn_rad, _TURN_RAD_S, dt_s),
            _arm_towards(now.right, goal.right, dt_s),
            _arm_towards(now.left, goal.left, dt_s),
            now.apart_rad + _step(goal.apart_rad - now.apart_rad, _LIMB_RAD_S, dt_s),
        )
        speed = step / dt_s if dt_s > 0 else 0.0
        return acted(self._key, Walk((dx, dz), speed, self._walked_m), self._phase)


def key_of(wish: Wish, t_s: float) -> Key:
    """The key pose of a wish that has come true."""
    if wish.gesture == "engage":
        right, left = beside_head(1.0), beside_head(-1.0)
    elif wish.gesture == "stop":
        right, left = _crossed(1.0), _crossed(-1.0)
    else:
        right, left = _arm(1.0, wish.right), _arm(-1.0, wish.left)
    return Key(t_s, wish.x_m, wish.z_m, radians(wish.turn_deg), right, left, radians(wish.apart_deg))


def _arm(sign: float, wish: ArmWish) -> ArmKey:
    raised = max(wish.side_deg, wish.front_deg)
    if raised < _HANGING_DEG and wish.elbow_deg > 150.0:
        return hanging(sign, _CURL[wish.hand])
    return arm(sign, wish.side_deg, wish.front_deg, wish.elbow_deg, palm=_FRONT, curl=_CURL[wish.hand])


def _crossed(sign: float) -> ArmKey:
    """A forearm across the chest; the right one lies before the left one."""
    ahead = 0.9 if sign > 0 else 0.5
    upper = unit(np.array([-sign * 0.4, -1.0, -ahead]))
    fore = unit(np.array([-sign * 1.0, 0.55, 0.0]))
    return ArmKey(upper, fore, unit(np.array([0.0, -0.2, 1.0])), RELAXED)


def _arm_towards(now: ArmKey, goal: ArmKey, dt_s: float) -> ArmKey:
    curl = now.curl + _step(goal.curl - now.curl, _CURL_PER_S, dt_s)
    return replace(
        now,
        upper=_towards(now.upper, goal.upper, dt_s),
        fore=_towards(now.fore, goal.fore, dt_s),
        palm=_towards(now.palm, goal.palm, dt_s),
        curl=curl,
    )


def _towards(now: Floats, goal: Floats, dt_s: float) -> Floats:
    """A direction (3,) turned towards another one."""
    angle = float(np.arccos(np.clip(now @ goal, -1.0, 1.0)))
    if angle < 1e-4:
        return goal
    if angle > np.pi - 1e-3:  # opposite: any way round is the shortest
        now = unit(now + np.array([1e-2, 0.0, -1e-2]))
    return turned(now, goal, _step(angle, _LIMB_RAD_S, dt_s) / angle)


def _step(way: float, most_per_s: float, dt_s: float) -> float:
    """How much of a way is gone in ``dt_s``: no faster than a limit, and eased out at its end."""
    eased = way * (1.0 - exp(-dt_s / _EASE_S))
    most = most_per_s * dt_s
    return min(max(eased, -most), most)
