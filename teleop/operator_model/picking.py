"""Picking one fruit: step to the right place, reach, correct what is seen, grip, cut, let go over the box. Pure."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any, Final

import numpy as np

from robot_sim.arm_angles import ARM_AXES
from robot_sim.commands import ArmTarget
from robot_sim.config import RobotConfig
from robot_sim.urdf_parts_tools import GRIP_M
from teleop.intent_types import Mode, Side
from teleop.operator_model.body import FIST, OPEN, ArmPosture, Body, Posture
from teleop.operator_model.console import ConsoleView, Scenery
from teleop.operator_model.eye import drawn_arm, grip_point_m, gripper_m, hand_m
from teleop.operator_model.stepping import Step, off_map_m, step_for, stepping_back
from teleop.operator_model.traits import Traits
from teleop.people.rig import Floats

PICK_APART_DEG: Final = 24.0
PELVIS_BEHIND_M: Final = 0.1
"""The pelvis' joint lies so far behind the spine's, about."""
HANG: Final = ArmPosture(5.0, 4.0, 168.0, 10.0)
"""An arm at rest."""
BOX_READY: Final = ArmTarget(15.0, 0.0, 120.0)
"""The left arm with the box before the chest, out of the right arm's way."""
BOX_UNDER: Final = ArmTarget(30.0, 0.0, 135.0)
"""The box level under the gripper."""
TUCK_DEG: Final = -5.0
"""Elbows held in: an upper arm that points forward is read as pointing outward a little."""
_TUCK_MORE_DEG: Final = 5.0
_DEEP_M: Final = 0.03
"""So far along the pads, from their middle, a fruit is between them for sure."""
_HIGH_M: Final = 0.025
"""So far above or below, the blades still have the peduncle between them."""
_SINKS_M: Final = 0.01
"""Practice has taught to aim so much higher: an arm sinks a little when its hand closes."""
_ALONG_M: Final = 0.03
"""Off by more along the row, it is worth a step."""
_REACH_M: Final = 0.045
"""Off by more, the jaws, which open 6 cm to each side, would not take it; the shortest step is twice as long."""
_BEYOND_DEG: Final = 3.0
"""Raised so far beyond a step of the upper arm, it is taken at once."""
_STILL_RAD: Final = 0.025
_CLOSING_SHARE: Final = 0.8
"""Jaws that have come this far are seen to close."""
_CUTTING_SHARE: Final = 0.3
"""A blade that has come this far is seen to close."""
_BEFORE: Final = 3
"""Paintings that a motion is seen by: a tenth of a second."""
_FOLLOWS_S: Final = 0.1
"""So soon after the own arm the robot's comes to rest."""
_RETRY_S: Final = 1.3
_UPPER_DEG: Final = (15.0, 30.0, 45.0, 60.0, 75.0)
_ELBOW_DEG: Final = np.arange(95.0, 171.0)


class Stage(StrEnum):
    """What is being done."""

    LOOK = "look"
    STEP = "step"
    AIM = "aim"
    GRIP = "grip"
    CUT = "cut"
    DROP = "drop"


@dataclass(frozen=True, slots=True, eq=False)
class Picker:
    """The operator's mind at this task. fruit: which one was pointed out. posture: what the body is asked to do.

    since_s: begin of the stage. true_s: since when what the stage waits for is seen. plan: how the robot's right arm
    is to stand. spread: the robot's arms were seen to hang outward. off_map_m: see stepping. views: the last
    paintings seen.
    """

    traits: Traits
    fruit: str
    config: RobotConfig
    scenery: Scenery
    posture: Posture
    stage: Stage = Stage.LOOK
    since_s: float = 0.0
    true_s: float | None = None
    plan: ArmTarget | None = None
    spread: bool = False
    off_map_m: float = 0.0
    step: Step | None = None
    steps: int = 0
    views: tuple[ConsoleView, ...] = ()

    def think(self, view: ConsoleView | None, body: Body, t_s: float) -> Picker:
        """One moment. view: the newest painting that has reached the operator. body: as they feel it."""
        if view is None:
            return self
        after = _STAGES[self.stage](self, view, body, t_s)
        return replace(after, views=(*after.views[-_BEFORE:], view))


def ready_to_pick(traits: Traits) -> Posture:
    """Arms down, hands open, legs apart: the task is picking."""
    return Posture(0.0, traits.practice.home_z_m + PELVIS_BEHIND_M, PICK_APART_DEG, HANG, HANG, OPEN, OPEN)


def best_pose(mind: Picker, view: ConsoleView, t_s: float, upper_deg: Sequence[float]) -> ArmTarget:
    """The pose of the robot's right arm that brings the gripper nearest to the fruit, seen from the side.

    The upper arm takes one of some steps, the elbow does the rest; a level forearm is better than a steep one.
    """
    goal = (
        grip_point_m(view, mind.scenery, mind.fruit, mind.config) + mind.traits.eye.error_m(t_s) + [0.0, 0.0, _SINKS_M]
    )
    best, least = ArmTarget(_UPPER_DEG[0], 0.0, 135.0), np.inf
    for c1 in upper_deg:
        for elbow in _ELBOW_DEG:
            target = ArmTarget(c1, 0.0, float(elbow))
            off = goal - hand_m(view, "right", target, GRIP_M, mind.config)
            cost = float(np.hypot(off[1], off[2])) + 0.0004 * abs(c1 + 90.0 - elbow)
            if cost < least:
                best, least = target, cost
    return best


def _gap_m(mind: Picker, view: ConsoleView, t_s: float, arm: ArmTarget) -> Floats:
    """(3,) from the gripper, with the arm so, to where the fruit is best gripped, as read off the screen."""
    goal = grip_point_m(view, mind.scenery, mind.fruit, mind.config) + mind.traits.eye.error_m(t_s)
    return np.asarray(goal - hand_m(view, "right", arm, GRIP_M, mind.config))


def _enter(mind: Picker, stage: Stage, t_s: float, **change: Any) -> Picker:
    return replace(mind, stage=stage, since_s=t_s, true_s=None, posture=replace(mind.posture, **change))


def _sure(mind: Picker, seen: bool, t_s: float) -> tuple[Picker, bool]:
    """Whether something has been seen for long enough to go on."""
    if not seen:
        return replace(mind, true_s=None), False
    true_s = t_s if mind.true_s is None else mind.true_s
    return replace(mind, true_s=true_s), t_s - true_s >= mind.traits.sure_s


def _look(mind: Picker, view: ConsoleView, _body: Body, t_s: float) -> Picker:
    """Judge how the arm must stand and how far the robot must go; then set off."""
    if t_s < mind.traits.reaction_s:
        return mind
    plan = best_pose(mind, view, t_s, _UPPER_DEG)
    ahead_m = float(_gap_m(mind, view, t_s, plan)[0])
    spread = any(target is not None and target.c2_deg > 0.0 for target in view.targets.values())
    mind = replace(mind, plan=plan, spread=spread, off_map_m=off_map_m(mind.posture, view))
    return _set_off(mind, ahead_m, t_s) if abs(ahead_m) > _ALONG_M else _reach(mind, t_s)


def _set_off(mind: Picker, ahead_m: float, t_s: float) -> Picker:
    step = step_for(ahead_m, mind.traits, mind.steps)
    return _enter(replace(mind, step=step, steps=mind.steps + 1), Stage.STEP, t_s, z_m=step.z_m + mind.off_map_m)


def _step(mind: Picker, _view: ConsoleView, body: Body, t_s: float) -> Picker:
    return _reach(mind, t_s) if mind.step is None or stepping_back(mind.step, body, t_s) else mind


def _reach(mind: Picker, t_s: float) -> Picker:
    """Home, both arms up on the way."""
    mind = _enter(mind, Stage.AIM, t_s, z_m=mind.traits.practice.home_z_m + mind.off_map_m)
    if mind.plan is None or mind.steps > 1:
        return mind
    swivel = mind.traits.swivel_deg
    tuck_deg = TUCK_DEG - (_TUCK_MORE_DEG if mind.spread else 0.0)
    right = ArmPosture(tuck_deg, mind.plan.c1_deg + _BEYOND_DEG, mind.plan.elbow_deg, swivel)
    left = ArmPosture(tuck_deg, BOX_READY.c1_deg + _BEYOND_DEG, BOX_READY.elbow_deg, swivel)
    return replace(mind, posture=replace(mind.posture, right=right, left=left))


def _aim(mind: Picker, view: ConsoleView, body: Body, t_s: float) -> Picker:
    """Wait until the robot's arms are at rest; correct what is seen to be wrong; go on when it looks right."""
    rest_s = max(body.parts[name].end_s for name in ("right", "left", "place")) + _FOLLOWS_S
    if view.mode is not Mode.PICKING or view.t_s < rest_s or not _still(mind, view):
        return replace(mind, true_s=None)
    along, deep, high = _gap_m(mind, view, t_s, drawn_arm(view, "right"))
    right, left = _tucked(mind.posture.right, view, "right"), _tucked(mind.posture.left, view, "left")
    if abs(deep) > _DEEP_M or abs(high + _SINKS_M) > _HIGH_M:
        right = _nearer(right, mind, view, t_s)
    elif abs(along) > _REACH_M and right == mind.posture.right:
        return _set_off(mind, float(along), t_s)
    posture = replace(mind.posture, right=right, left=left)
    if posture != mind.posture:
        return replace(mind, posture=posture, true_s=None)
    mind, sure = _sure(mind, True, t_s)
    if not sure:
        return mind
    under = replace(left, front_deg=BOX_UNDER.c1_deg + _BEYOND_DEG, elbow_deg=BOX_UNDER.elbow_deg)
    return _enter(mind, Stage.GRIP, t_s, right_curl=FIST, left=under)


def _still(mind: Picker, view: ConsoleView) -> bool:
    if len(mind.views) < _BEFORE or mind.views[-_BEFORE].mode is not Mode.PICKING:
        return False
    before = mind.views[-_BEFORE].joint_rad
    return (
        max(
            abs(view.joint_rad[f"{arm}_{axis}"] - before[f"{arm}_{axis}"])
            for arm in ("right", "left")
            for axis in ARM_AXES
        )
        < _STILL_RAD
    )


def _nearer(own: ArmPosture, mind: Picker, view: ConsoleView, t_s: float) -> ArmPosture:
    """The own arm moved by as much as the robot's has still to move; the upper arm by how the console reads it."""
    drawn, read_deg = drawn_arm(view, "right"), view.angles.right.theta2_deg
    better = best_pose(mind, view, t_s, [c for c in _UPPER_DEG if abs(c - drawn.c1_deg) <= 20.0])
    front_deg, elbow = own.front_deg, float(np.clip(better.elbow_deg - drawn.elbow_deg, -25.0, 25.0))
    if read_deg is not None and abs(better.c1_deg - drawn.c1_deg) > 7.5:
        front_deg += float(np.clip(better.c1_deg - read_deg, -15.0, 15.0))
    return replace(own, front_deg=front_deg, elbow_deg=float(np.clip(own.elbow_deg + elbow, 90.0, 172.0)))


def _tucked(own: ArmPosture, view: ConsoleView, arm: Side) -> ArmPosture:
    """The elbow drawn in when the robot's arm is seen to swing outward."""
    target = view.targets[arm]
    out = target is not None and target.c2_deg != 0.0
    return replace(own, side_deg=max(own.side_deg - _TUCK_MORE_DEG, -14.0)) if out else own


def _grip(mind: Picker, view: ConsoleView, _body: Body, t_s: float) -> Picker:
    """The cutting hand closes as soon as the jaws are seen to: it takes longer than they do."""
    jaws_m = max(view.joint_rad["gripper_left"], view.joint_rad["gripper_right"])
    mind, sure = _sure(mind, jaws_m < _CLOSING_SHARE * mind.config.tool.jaw.upper, t_s)
    if sure:
        return _enter(mind, Stage.CUT, t_s, left_curl=FIST)
    return replace(mind, posture=replace(mind.posture, right_curl=_fist_again(mind, t_s)))


def _cut(mind: Picker, view: ConsoleView, _body: Body, t_s: float) -> Picker:
    """The other hand opens as soon as the blade is seen to close: the blade is quicker."""
    mind, sure = _sure(mind, view.joint_rad["cutter"] > _CUTTING_SHARE * mind.config.tool.cutter.upper, t_s)
    if sure:
        return _enter(mind, Stage.DROP, t_s, right_curl=OPEN)
    return replace(mind, posture=replace(mind.posture, left_curl=_fist_again(mind, t_s)))


def _fist_again(mind: Picker, t_s: float) -> float:
    """A fist; one that had no effect is opened for a moment and made again."""
    return OPEN if (t_s - mind.since_s) % (_RETRY_S + 0.5) > _RETRY_S else FIST


def _drop(mind: Picker, view: ConsoleView, _body: Body, t_s: float) -> Picker:
    """Done when the fruit is seen to have fallen; one that still hangs is picked anew."""
    hangs = (
        np.linalg.norm(grip_point_m(view, mind.scenery, mind.fruit, mind.config) - gripper_m(view, mind.config)) < 0.08
    )
    if hangs and t_s - mind.since_s > _RETRY_S:
        return _enter(mind, Stage.AIM, t_s, right_curl=OPEN, left_curl=OPEN)
    return mind


_STAGES: Final[dict[Stage, Callable[[Picker, ConsoleView, Body, float], Picker]]] = {
    Stage.LOOK: _look,
    Stage.STEP: _step,
    Stage.AIM: _aim,
    Stage.GRIP: _grip,
    Stage.CUT: _cut,
    Stage.DROP: _drop,
}
