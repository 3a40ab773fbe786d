"""Which fruit to pick when nobody names one."""

from __future__ import annotations

import numpy as np

from robot_sim.commands import ArmTarget
from robot_sim.config import RobotConfig
from robot_sim.pick.plan import PickPlan, Scenery, plan_pick, where_fruits_are
from robot_sim.pick.refusal import Refusal
from robot_sim.reach import hand_in_chest
from robot_sim.reasons import RobotReason
from robot_sim.stance import stance_of
from robot_sim.state import RobotState
from robot_sim.urdf_parts_chassis import DISC_HEIGHT_M
from robot_sim.urdf_parts_tools import GRIP_M

EASY = ArmTarget(45.0, 0.0, 135.0)
"""The right arm half raised, its forearm level: fruit near that hand is easiest to pick."""
TRIED = 3


def nearest_ripe(scenery: Scenery, state: RobotState, config: RobotConfig) -> tuple[str, PickPlan | Refusal]:
    """The ripe fruit that is easiest to reach, and the plan for it; the first of the nearest three that has a plan."""
    places = where_fruits_are(scenery, state)
    ripe = [fruit.name for fruit in scenery.grown if fruit.ripe and fruit.name in places]
    if not ripe:
        return "", Refusal(RobotReason.PICK_NO_FRUIT, "the robot knows of no ripe fruit that hangs")
    hand = hand_in_chest("right", EASY, GRIP_M, config) + np.array([0.0, 0.0, DISC_HEIGHT_M])
    away = stance_of(state).to_disc(np.array([places[name] for name in ripe]), config) - hand
    # the lift goes after the height, so what is level counts most
    order = np.argsort(np.hypot(np.hypot(away[:, 0], away[:, 1]), 0.3 * away[:, 2]), kind="stable")
    first: tuple[str, PickPlan | Refusal] | None = None
    for i in order[:TRIED]:
        found = plan_pick(ripe[i], scenery, state, config)
        if isinstance(found, PickPlan):
            return ripe[i], found
        first = first or (ripe[i], found)
    assert first is not None
    return first
