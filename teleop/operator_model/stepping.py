"""Moving the chassis by stepping out of the working zone and back. Pure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from teleop.operator_model.body import Body, Posture
from teleop.operator_model.console import ConsoleView
from teleop.operator_model.traits import Traits


@dataclass(frozen=True, slots=True)
class Step:
    """A step that is being taken. z_m: where to on the floor map. wait_s: how long to stay there."""

    z_m: float
    wait_s: float


def step_for(ahead_m: float, traits: Traits, number: int) -> Step:
    """The step that moves the robot so far ahead, negative back, as practice has taught; people misjudge a pause.

    number: of the step, for that error.
    """
    known = traits.practice
    forward = ahead_m >= 0
    quicker_s = known.tap_s - traits.pace.step_s(known.home_z_m - known.in_z_m)
    tap = known.tap_m - known.tap_m_s * quicker_s if forward else known.back_tap_m
    speed = known.drive_m_s if forward else known.back_m_s
    wait_s = max(0.0, (abs(ahead_m) - tap) / speed)
    error = np.random.default_rng([traits.seed, 67, number]).normal(0.0, traits.timing)
    return Step(known.in_z_m if forward else known.out_z_m, wait_s * (1.0 + float(error)))


def stepping_back(step: Step, body: Body, t_s: float) -> bool:
    """Whether it is time to step back."""
    return t_s >= body.parts["place"].end_s + step.wait_s


def off_map_m(posture: Posture, view: ConsoleView) -> float:
    """How far behind their spot on the floor map somebody feels to stand, who stands still."""
    return 0.0 if view.spine_xz_m is None else posture.z_m - view.spine_xz_m[1]
