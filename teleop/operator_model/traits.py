"""Who the operator is: reactions, pace, eyes, habits of posture; and what practice has taught them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from teleop.operator_model.body import Pace
from teleop.operator_model.eye import Eye, new_eye


@dataclass(frozen=True, slots=True)
class Practice:
    """What everybody knows who has driven the robot for a while.

    home_z_m: to work, stand here on the floor map. in_z_m, out_z_m: step there to drive forward, back. tap_m: how far
    the robot goes when one steps forward in tap_s and at once home, tap_m_s less for each second that one is quicker;
    staying there adds drive_m_s. back_tap_m, back_m_s: the same backward.
    """

    home_z_m: float = 2.02
    in_z_m: float = 1.76
    out_z_m: float = 2.97
    tap_m: float = 0.102
    tap_s: float = 0.49
    tap_m_s: float = 0.28
    back_tap_m: float = 0.06
    drive_m_s: float = 0.3
    back_m_s: float = 0.2


@dataclass(frozen=True, slots=True, eq=False)
class Traits:
    """One person. late_s: from the robot's motion to the operator's mind, screen and eye together.

    reaction_s: from the word go to the first movement. sure_s: how long they look before the next step of a task.
    timing: standard deviation of a pause, as a part of it (Weber fraction of interval timing). swivel_deg: how they
    hold their forearms. seed: of all their errors.
    """

    seed: int
    pace: Pace
    eye: Eye
    reaction_s: float
    sure_s: float
    timing: float
    swivel_deg: float
    late_s: float = 0.2
    practice: Practice = Practice()


def traits_of(index: int, seed: int) -> Traits:
    """Tester ``index``: quick and slow, exact and less exact people; the same for the same seed."""
    rng = np.random.default_rng([61, seed, index])
    pace = Pace(
        arm_deg_s=float(rng.uniform(220.0, 320.0)),
        walk_m_s=float(rng.uniform(1.0, 1.3)),
        hand_s=float(rng.uniform(0.18, 0.26)),
        miss=float(rng.uniform(0.03, 0.07)),
    )
    return Traits(
        seed=int(rng.integers(2**31)),
        pace=pace,
        eye=new_eye(rng, bias_m=0.005, wander_m=0.006),
        reaction_s=float(rng.uniform(0.2, 0.32)),
        sure_s=float(rng.uniform(0.10, 0.25)),
        timing=0.06,
        swivel_deg=float(rng.uniform(38.0, 60.0)),
    )
