"""Spraying a piece of the row: step to its middle, close the legs, sweep, then go where it is still dry. Pure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any, Final

import numpy as np

from robot_sim.commands import ArmTarget, Liquid
from robot_sim.config import RobotConfig
from robot_sim.spray import LIQUIDS
from robot_sim.urdf_parts_tools import NOZZLE_M
from teleop.intent_types import Mode
from teleop.operator_model.body import FIST, OPEN, ArmPosture, Body, Posture
from teleop.operator_model.console import ConsoleView
from teleop.operator_model.eye import hand_m
from teleop.operator_model.picking import ready_to_pick
from teleop.operator_model.stepping import Step, off_map_m, step_for, stepping_back
from teleop.operator_model.traits import Traits
from teleop.people.rig import Floats

CLOSED_DEG: Final = 3.0
"""Between the thighs of legs that stand together."""
TUCK_DEG: Final = -2.0
_ALONG_M: Final = 0.05
_OPEN_AFTER_S: Final = 0.25
"""The task must be seen to be spraying before the hand opens."""
_LOOK_EVERY_S: Final = 0.3
_DRY_POWER: Final = 1.3
"""What is quite dry draws the eye more than what is half wet."""
_WORTH: Final = 1.15
"""Another aim must promise so much more."""
_UPPER_DEG: Final = (0.0, 15.0, 30.0, 45.0, 60.0)
_ELBOW_DEG: Final = tuple(range(90, 151, 10))
SWEEP: Final = ((0.0, 18.0, 125.0), (0.7, 18.0, 140.0), (1.25, 0.0, 90.0), (1.8, 8.0, 90.0), (2.0, 11.0, 90.0))
"""The sweep that practice on other crops has taught, from low to high: time [s], upper arm forward, elbow [deg]."""


class Stage(StrEnum):
    """What is being done."""

    LOOK = "look"
    STEP = "step"
    TURN = "turn"
    SWEEP = "sweep"
    REST = "rest"


@dataclass(frozen=True, slots=True, eq=False)
class Leaves:
    """The leaves of the piece to be sprayed, as drawn: names, middle_m (L, 3), area_m2 (L,)."""

    names: tuple[str, ...]
    middle_m: Floats
    area_m2: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Sprayer:
    """The operator's mind at this task. middle_x_m: of the piece along the row. on_s: since when spray is seen."""

    traits: Traits
    leaves: Leaves
    liquid: Liquid
    middle_x_m: float
    config: RobotConfig
    posture: Posture
    stage: Stage = Stage.LOOK
    since_s: float = 0.0
    seen_s: float | None = None
    on_s: float | None = None
    aim: tuple[float, float] = SWEEP[0][1:]
    aimed_s: float = 0.0
    off_map_m: float = 0.0
    step: Step | None = None
    steps: int = 0

    def think(self, view: ConsoleView | None, body: Body, t_s: float) -> Sprayer:
        """One moment. view: the newest painting that has reached the operator. body: as they feel it."""
        return self if view is None else _STAGES[self.stage](self, view, body, t_s)


def ready_to_spray(traits: Traits) -> Posture:
    """As after a pick: arms down, legs apart, so that the robot's right arm is at the crop."""
    return ready_to_pick(traits)


def _enter(mind: Sprayer, stage: Stage, t_s: float, **change: Any) -> Sprayer:
    return replace(mind, stage=stage, since_s=t_s, posture=replace(mind.posture, **change))


def _look(mind: Sprayer, view: ConsoleView, _body: Body, t_s: float) -> Sprayer:
    if t_s < mind.traits.reaction_s:
        return mind
    mind = replace(mind, off_map_m=off_map_m(mind.posture, view))
    ahead_m = mind.middle_x_m - view.base[0] + float(mind.traits.eye.error_m(t_s)[0])
    if abs(ahead_m) <= _ALONG_M:
        return _close_legs(mind, t_s)
    step = step_for(ahead_m, mind.traits, 0)
    return _enter(replace(mind, step=step, steps=1), Stage.STEP, t_s, z_m=step.z_m + mind.off_map_m)


def _step(mind: Sprayer, _view: ConsoleView, body: Body, t_s: float) -> Sprayer:
    return _close_legs(mind, t_s) if mind.step is None or stepping_back(mind.step, body, t_s) else mind


def _close_legs(mind: Sprayer, t_s: float) -> Sprayer:
    """Home, legs together, the spraying arm up, its hand still a fist."""
    home_m = mind.traits.practice.home_z_m + mind.off_map_m
    right = ArmPosture(TUCK_DEG, *SWEEP[0][1:], mind.traits.swivel_deg)
    return _enter(mind, Stage.TURN, t_s, z_m=home_m, apart_deg=CLOSED_DEG, right=right, right_curl=FIST)


def _turn(mind: Sprayer, view: ConsoleView, _body: Body, t_s: float) -> Sprayer:
    """The disc turns by itself; the hand opens on the way, so that it sprays as soon as the disc stands."""
    seen_s = (mind.seen_s or t_s) if view.mode is Mode.SPRAYING else None
    mind = replace(mind, seen_s=seen_s)
    if seen_s is None or t_s - seen_s < _OPEN_AFTER_S:
        return mind
    return _enter(mind, Stage.SWEEP, t_s, right_curl=OPEN)


def _sweep(mind: Sprayer, view: ConsoleView, _body: Body, t_s: float) -> Sprayer:
    if not view.spray_on:
        # not seen to spray although the disc stands: the hand was not read, close it and open it again
        stuck = abs(view.joint_rad["disc"] - np.pi) < 0.02 and t_s - max(mind.since_s, mind.on_s or 0.0) > 2.6
        return _enter(mind, Stage.TURN, t_s, right_curl=FIST) if stuck else mind
    begun_s = t_s - mind.traits.late_s if mind.on_s is None else mind.on_s
    mind = replace(mind, on_s=begun_s)
    swept_s = t_s - begun_s
    if swept_s < SWEEP[-1][0]:
        # the hand leads the way a moment ahead, as one follows a line
        times = [p[0] for p in SWEEP]
        aim = tuple(float(np.interp(swept_s + 0.1, times, [p[k] for p in SWEEP])) for k in (1, 2))
        return _aimed(mind, (aim[0], aim[1]), t_s) if t_s - mind.aimed_s > 0.1 else mind
    if t_s - mind.aimed_s < _LOOK_EVERY_S:
        return mind
    aim = driest(mind, view, t_s)
    return _aimed(mind, aim, t_s) if aim != mind.aim else replace(mind, aimed_s=t_s)


def _aimed(mind: Sprayer, aim: tuple[float, float], t_s: float) -> Sprayer:
    right = replace(mind.posture.right, front_deg=aim[0], elbow_deg=aim[1])
    return replace(mind, aim=aim, aimed_s=t_s, posture=replace(mind.posture, right=right))


def driest(mind: Sprayer, view: ConsoleView, t_s: float) -> tuple[float, float]:
    """Where to aim next: upper arm and elbow from which most of what is seen dry lies in the cone, and near."""
    k = LIQUIDS.index(mind.liquid)
    dry = np.array([1.0 - view.wet.get(name, (0.0, 0.0, 0.0))[k] for name in mind.leaves.names])
    wanted = dry**_DRY_POWER * mind.leaves.area_m2
    worth = {aim: float(promise(mind, view, aim, t_s) @ wanted) for aim in AIMS}
    best = max(worth, key=lambda aim: worth[aim])
    now = worth.get(mind.aim, 0.0)
    return best if worth[best] > _WORTH * now else mind.aim


AIMS: Final = tuple((c1, float(elbow)) for c1 in _UPPER_DEG for elbow in _ELBOW_DEG)


def promise(mind: Sprayer, view: ConsoleView, aim: tuple[float, float], t_s: float) -> Floats:
    """How much each leaf (L,) is thought to get per second: all in the cone, the nearer the more."""
    target = ArmTarget(aim[0], 0.0, aim[1])
    nozzle = hand_m(view, "rear", target, NOZZLE_M, mind.config)
    along = nozzle - hand_m(view, "rear", target, 0.0, mind.config)
    away = mind.leaves.middle_m + mind.traits.eye.error_m(t_s) - nozzle
    distance = np.maximum(np.linalg.norm(away, axis=1), 0.2)
    inside = away @ along >= distance * np.linalg.norm(along) * np.cos(mind.config.spray.cone_rad)
    return np.asarray(inside * (distance < mind.config.spray.range_m) / distance**2)


_STAGES: Final[dict[Stage, Callable[[Sprayer, ConsoleView, Body, float], Sprayer]]] = {
    Stage.LOOK: _look,
    Stage.STEP: _step,
    Stage.TURN: _turn,
    Stage.SWEEP: _sweep,
}
