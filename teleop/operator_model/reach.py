"""Minimum-jerk movements that can be given another goal while they are under way. Pure functions of time.

The smoothest movement from any place, speed and acceleration to rest at a goal is a polynomial of degree five
(Hoff and Arbib, "Models of trajectory formation and temporal interaction of reach and grasp", J. Motor Behavior 1993).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from teleop.people.rig import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Reach:
    """One movement of n numbers. From place, speed, acceleration (n,) at start_s to rest at goal (n,) after lasts_s."""

    start_s: float
    lasts_s: float
    place: Floats
    speed: Floats
    acceleration: Floats
    goal: Floats

    @property
    def end_s(self) -> float:
        """When the goal is reached."""
        return self.start_s + self.lasts_s

    def at(self, t_s: float) -> tuple[Floats, Floats, Floats]:
        """Place, speed and acceleration (n,) at a time; before the start as at the start, at rest after the end."""
        if t_s >= self.end_s:
            still = np.zeros_like(self.goal)
            return self.goal, still, still
        t = max(0.0, t_s - self.start_s)
        T = self.lasts_s
        p, v, a = self.place, self.speed, self.acceleration
        # coefficients of t^3, t^4, t^5 that end at the goal without speed and acceleration
        d = self.goal - p - v * T - 0.5 * a * T**2
        dv, da = -v - a * T, -a
        c3 = (10 * d - 4 * dv * T + 0.5 * da * T**2) / T**3
        c4 = (-15 * d + 7 * dv * T - da * T**2) / T**4
        c5 = (6 * d - 3 * dv * T + 0.5 * da * T**2) / T**5
        return (
            p + t * (v + t * (0.5 * a + t * (c3 + t * (c4 + t * c5)))),
            v + t * (a + t * (3 * c3 + t * (4 * c4 + t * 5 * c5))),
            a + t * (6 * c3 + t * (12 * c4 + t * 20 * c5)),
        )

    def towards(self, goal: Floats, t_s: float, lasts_s: float) -> Reach:
        """From where this movement is at a time to another goal. lasts_s: above 0."""
        return Reach(t_s, lasts_s, *self.at(t_s), goal)


def resting(place: Floats) -> Reach:
    """No movement at all."""
    still = np.zeros_like(place)
    return Reach(0.0, 1e-9, place, still, still, place)
