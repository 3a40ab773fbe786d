"""Picking one fruit with the robot's help: point at it, confirm with the left fist, keep both hands closed. Pure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any, Final

import numpy as np

from robot_sim.config import RobotConfig
from robot_sim.derived import derived
from robot_sim.stance import Stance
from robot_sim.urdf_parts_arms import shoulder_pose
from teleop.operator_model.body import FIST, OPEN, ArmPosture, Body, Posture
from teleop.operator_model.console import ConsoleView, Scenery
from teleop.operator_model.eye import fruit_m
from teleop.operator_model.picking import HANG
from teleop.operator_model.traits import Traits
from teleop.people.rig import Floats

BESIDE_HEAD: Final = ArmPosture(68.0, 8.0, 68.0, 84.0)
"""An open hand beside the head, elbow bent: the other arm points now."""
STRAIGHT_DEG: Final = 170.0
_CORRECTED: Final = 0.7
"""Share of what is seen to be wrong that is corrected at once."""
_LOOKS_S: Final = 1.6
"""So long the halo of another fruit, or none, is waited for before pointing is corrected."""
_FIST_S: Final = 1.6
"""A fist that has had no effect for so long is opened and made again."""
_OPEN_S: Final = 0.6


class Stage(StrEnum):
    """What is being done."""

    LOOK = "look"
    POINT = "point"
    LOWER = "lower"
    CONFIRM = "confirm"
    WATCH = "watch"


@dataclass(frozen=True, slots=True, eq=False)
class HelpedPicker:
    """The operator's mind at this task. fruit: which one was pointed out. aim (3,): where they believe they must point,
    in the robot's chest axes (forward, left, up). since_s: begin of the stage. steps: none are taken."""

    traits: Traits
    fruit: str
    config: RobotConfig
    scenery: Scenery
    posture: Posture
    stage: Stage = Stage.LOOK
    since_s: float = 0.0
    aim: Floats | None = None
    steps: int = 0

    def think(self, view: ConsoleView | None, body: Body, t_s: float) -> HelpedPicker:
        """One moment. view: the newest painting that has reached the operator. body: as they feel it."""
        return self if view is None else _STAGES[self.stage](self, view, body, t_s)


def pointing(direction: Floats, swivel_deg: float) -> ArmPosture:
    """The right arm that points along a direction (3,) of the chest's axes, below the shoulder."""
    forward, left, up = direction
    down = max(-float(up), 0.05)
    side, front = np.degrees(np.arctan2([-left, forward], down))
    return ArmPosture(float(side), float(front), STRAIGHT_DEG, swivel_deg)


def _seen_from_shoulder(mind: HelpedPicker, view: ConsoleView, fruit: str, t_s: float) -> Floats:
    """(3,) unit vector from the robot's right shoulder to a fruit as it is read off the screen."""
    at = fruit_m(view, mind.scenery, fruit) + mind.traits.eye.error_m(t_s)
    x, y, yaw = view.base
    stance = Stance(x, y, yaw, view.joint_rad["lift"], view.joint_rad["disc"])
    away = stance.to_disc(at, mind.config) - _shoulder_m(mind.config)
    return np.asarray(away / np.linalg.norm(away))


@derived
def _shoulder_m(config: RobotConfig) -> Floats:
    return np.array(shoulder_pose("right", config)[0])


def _enter(mind: HelpedPicker, stage: Stage, t_s: float, **change: Any) -> HelpedPicker:
    return replace(mind, stage=stage, since_s=t_s, posture=replace(mind.posture, **change))


def _look(mind: HelpedPicker, view: ConsoleView, _body: Body, t_s: float) -> HelpedPicker:
    """Read off the screen where the fruit hangs from the robot's shoulder; raise one hand, point with the other."""
    if t_s < mind.traits.reaction_s:
        return mind
    return _point_along(mind, _seen_from_shoulder(mind, view, mind.fruit, t_s), t_s)


def _point_along(mind: HelpedPicker, aim: Floats, t_s: float) -> HelpedPicker:
    right = pointing(aim, mind.traits.swivel_deg)
    return _enter(
        replace(mind, aim=aim), Stage.POINT, t_s, right=right, left=BESIDE_HEAD, right_curl=OPEN, left_curl=OPEN
    )


def _point(mind: HelpedPicker, view: ConsoleView, body: Body, t_s: float) -> HelpedPicker:
    """Wait for the preview of this fruit; when another one or none is lit up, point as much the other way."""
    if view.picked == (mind.fruit, "preview"):
        return _enter(mind, Stage.LOWER, t_s, right=HANG, left=HANG)
    at_rest_s = max(body.parts[name].end_s for name in ("right", "left"))
    if t_s < max(at_rest_s, mind.since_s) + _LOOKS_S or mind.aim is None:
        return mind
    if view.picked is not None and view.picked[1] in ("preview", "refused"):
        # the hand beside the head has to go before it counts anew
        return _enter(mind, Stage.LOOK, t_s, left=HANG, right=HANG)
    right = _seen_from_shoulder(mind, view, mind.fruit, t_s)
    if view.aimed is None:
        return _point_along(mind, right, t_s)
    wrong = _seen_from_shoulder(mind, view, view.aimed, t_s)
    return _point_along(mind, mind.aim + _CORRECTED * (right - wrong), t_s)


def _lower(mind: HelpedPicker, _view: ConsoleView, body: Body, t_s: float) -> HelpedPicker:
    """Arms down, hands open; then both fists: the left one confirms."""
    if not all(body.done(name, t_s) for name in ("right", "left")) or t_s - mind.since_s < _OPEN_S:
        return mind
    return _enter(mind, Stage.CONFIRM, t_s, right_curl=FIST, left_curl=FIST)


def _confirm(mind: HelpedPicker, view: ConsoleView, _body: Body, t_s: float) -> HelpedPicker:
    """Until the robot is seen to have begun; a fist that did nothing is opened and made again."""
    if view.picked is not None and view.picked[1] == "running":
        return _enter(mind, Stage.WATCH, t_s)
    if t_s - mind.since_s > _FIST_S:
        return _enter(mind, Stage.LOWER, t_s, right_curl=OPEN, left_curl=OPEN)
    return mind


def _watch(mind: HelpedPicker, view: ConsoleView, _body: Body, t_s: float) -> HelpedPicker:
    """Hands closed until it is done; if it ended otherwise, from the start."""
    if view.picked is None or view.picked[1] in ("running", "succeeded"):
        return mind
    return _enter(mind, Stage.LOOK, t_s, right=HANG, left=HANG, right_curl=OPEN, left_curl=OPEN)


_STAGES: Final[dict[Stage, Callable[[HelpedPicker, ConsoleView, Body, float], HelpedPicker]]] = {
    Stage.LOOK: _look,
    Stage.POINT: _point,
    Stage.LOWER: _lower,
    Stage.CONFIRM: _confirm,
    Stage.WATCH: _watch,
}
