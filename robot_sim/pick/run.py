"""A pick under way, stage by stage: what the robot is asked next, from what it reports. Pure."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from math import copysign, cos, sin, sqrt

import numpy as np

from robot_sim.arm_angles import arm_joint_names
from robot_sim.commands import RobotCommand
from robot_sim.config import RobotConfig
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.pick.arm_space import targets_of
from robot_sim.pick.motions import Leg
from robot_sim.pick.plan import PickPlan, Scenery, plan_pick
from robot_sim.pick.refusal import Refusal
from robot_sim.reasons import RobotReason
from robot_sim.state import RobotState
from robot_sim.trajectories import Trajectory

LAG_RAD = 0.3
"""Arms further behind their motion than this are waited for."""
SETTLED_RAD = 0.02
AT_REST_M_S = 0.02
BRAKING = 0.6
"""Share of the chassis' own braking that the way to a place counts on."""
ALIGNMENTS = 2
"""So often the robot may place itself before it gives up."""
LONGEST_STEP_S = 0.2
BLADE_S, JAW_S, FALL_S = 0.25, 0.45, 0.35
"""What closing the cutter, closing the gripper and falling into the box take, for the progress."""


class Stage(StrEnum):
    """Where a pick is. ALIGN: chassis, lift; the others as they are called."""

    ALIGN = "align"
    APPROACH = "approach"
    CLAMP = "clamp"
    HOLD = "hold"
    CUT = "cut"
    RETREAT = "retreat"
    BOX = "box"


STAGES: tuple[Stage, ...] = tuple(Stage)


@dataclass(frozen=True, slots=True, eq=False)
class PickRun:
    """One pick.

    leg, motion_s: the motion under way and how far it is [s]. stage_s: time in the stage; idle_s: time without
    progress; last_s: the robot's clock at the last step. parts_s: about how long every stage takes. alignments: how
    often it placed itself. opened_s: when in the stage the gripper let go over the box. failure: why it ended early.
    done: it ended well.
    """

    plan: PickPlan
    last_s: float
    stage: Stage = Stage.ALIGN
    leg: Leg | None = Leg.TUCK
    motion_s: float = 0.0
    stage_s: float = 0.0
    idle_s: float = 0.0
    parts_s: tuple[float, ...] = (1.0,) * len(STAGES)
    alignments: int = 1
    opened_s: float | None = None
    failure: Refusal | None = None
    done: bool = False

    @property
    def over(self) -> bool:
        """Whether there is nothing left to do."""
        return self.done or self.failure is not None


def begin(plan: PickPlan, state: RobotState, config: RobotConfig) -> PickRun:
    """A pick that starts now."""
    return PickRun(
        plan,
        state.sim_time_s,
        leg=Leg.TUCK if Leg.TUCK in plan.motions else None,
        parts_s=_parts_s(plan, plan.stance.lift_m - state.joint_rad["lift"], config),
    )


def hold(run: PickRun, state: RobotState) -> PickRun:
    """Nothing may move now; the pick goes on from here later."""
    return replace(run, last_s=state.sim_time_s)


def step(run: PickRun, scenery: Scenery, state: RobotState, config: RobotConfig) -> tuple[PickRun, RobotCommand]:
    """What is asked of the robot until the next step, and the pick as it stands after this one."""
    dt_s = min(max(state.sim_time_s - run.last_s, 0.0), LONGEST_STEP_S)
    run = replace(run, last_s=state.sim_time_s, stage_s=run.stage_s + dt_s)
    command = RobotCommand(t_ns=0, cutter_closed=False, gripper_open=run.stage in (Stage.ALIGN, Stage.APPROACH))
    if run.over:
        return run, replace(command, gripper_open=None)
    if run.stage is Stage.ALIGN:
        return _align(run, scenery, state, dt_s, command, config)
    if run.stage is Stage.APPROACH:
        return _move(run, state, dt_s, command, config)
    if run.stage is Stage.CLAMP:
        return _clamp(run, state, config), command
    if run.stage is Stage.BOX and run.opened_s is not None:
        return _let_go(run, state, dt_s, command, config)
    if not _held(run, state):
        return _failed(run, RobotReason.PICK_LOST, "the fruit slipped out of the gripper"), command
    if run.stage is Stage.HOLD:
        return (_next(run, Stage.CUT, None) if run.stage_s >= config.pick.hold_s else run), command
    if run.stage is Stage.CUT:
        return _cut(run, state, dt_s, config), replace(command, cutter_closed=True)
    return _move(run, state, dt_s, command, config)


def _align(
    run: PickRun, scenery: Scenery, state: RobotState, dt_s: float, command: RobotCommand, config: RobotConfig
) -> tuple[PickRun, RobotCommand]:
    if run.leg is Leg.TUCK:
        return _move(run, state, dt_s, command, config)
    pick, plan = config.pick, run.plan
    along = (cos(state.base_yaw_rad), sin(state.base_yaw_rad))
    ahead = (plan.stance.x_m - state.base_x_m) * along[0] + (plan.stance.y_m - state.base_y_m) * along[1]
    rise = plan.stance.lift_m - state.joint_rad["lift"]
    there = abs(ahead) < pick.arrived_m
    if there and abs(rise) < pick.arrived_m and abs(state.drive_m_s) < AT_REST_M_S:
        return _aligned(run, scenery, state, config), command
    moving = abs(state.drive_m_s) > 0.25 * AT_REST_M_S or state.target_rad["lift"] != state.joint_rad["lift"]
    run = _waited(run, dt_s, moving, state, config)
    # the fastest speed from which it still comes to rest there
    most = min(pick.drive_m_s, sqrt(2.0 * BRAKING * config.chassis.drive_m_s2 * abs(ahead)))
    return run, replace(command, drive_m_s=0.0 if there else copysign(most, ahead), lift_m=plan.stance.lift_m)


def _aligned(run: PickRun, scenery: Scenery, state: RobotState, config: RobotConfig) -> PickRun:
    """Tracks and lift are some millimetres off: the arms' motions are planned anew from where the robot stands now."""
    found = plan_pick(run.plan.fruit, scenery, state, config, stay=True)
    if not isinstance(found, Refusal):
        return _next(replace(run, plan=found), Stage.APPROACH, Leg.REACH)
    again = plan_pick(run.plan.fruit, scenery, state, config)
    if isinstance(again, Refusal) or run.alignments >= ALIGNMENTS:
        return replace(run, failure=found)
    return replace(begin(again, state, config), alignments=run.alignments + 1)


def _clamp(run: PickRun, state: RobotState, config: RobotConfig) -> PickRun:
    if _held(run, state):
        return _next(run, Stage.HOLD, None)
    if run.stage_s > config.pick.patience_s:
        return _failed(run, RobotReason.PICK_NOT_GRIPPED, "the gripper closed without the fruit between its pads")
    return run


def _cut(run: PickRun, state: RobotState, dt_s: float, config: RobotConfig) -> PickRun:
    if RobotReason.NOTHING_CUT in state.reasons:
        return _failed(run, RobotReason.NOTHING_CUT, "the blades met no peduncle; move the lift a little")
    if state.joint_rad["cutter"] >= config.tool.cutter.upper - 0.03 and run.stage_s > BLADE_S:
        return _next(run, Stage.RETREAT, Leg.RETREAT)
    return _waited(run, dt_s, False, state, config)


def _let_go(
    run: PickRun, state: RobotState, dt_s: float, command: RobotCommand, config: RobotConfig
) -> tuple[PickRun, RobotCommand]:
    """Open over the box, wait for the fruit to lie in it, then back up."""
    command = replace(command, gripper_open=True)
    if run.leg is not None:
        return _move(run, state, dt_s, command, config)
    assert run.opened_s is not None
    open_s = run.stage_s - run.opened_s
    if _status(run, state).startswith("boxed") and open_s > FALL_S:
        return replace(run, leg=Leg.LOWER, motion_s=0.0), command
    if open_s > config.pick.patience_s:
        run = _failed(run, RobotReason.PICK_NOT_BOXED, "the fruit is not in the box; look where it lies")
    return run, command


def _move(
    run: PickRun, state: RobotState, dt_s: float, command: RobotCommand, config: RobotConfig
) -> tuple[PickRun, RobotCommand]:
    """Along the motion of the leg; it waits while the arms do not follow, and gives up after a while."""
    assert run.leg is not None
    motion = run.plan.motions[run.leg]
    arms = np.array([state.target_rad[j] for arm in ("right", "left") for j in arm_joint_names(arm)])
    behind = float(np.abs(_at(run, motion, run.motion_s) - arms).max())
    ended = run.motion_s >= motion.duration_s
    if ended and behind < SETTLED_RAD:
        return _arrived(run), command
    follows = behind <= LAG_RAD
    if follows and not ended:
        run = replace(run, motion_s=min(run.motion_s + dt_s, motion.duration_s))
    run = _waited(run, dt_s, follows and not ended, state, config)
    right, left = targets_of(_at(run, motion, run.motion_s))
    return run, replace(command, right_arm=right, left_arm=left)


def _at(run: PickRun, motion: Trajectory, t_s: float) -> FloatArray:
    """Both arms at a time of a motion; the way out of the box is the way into it backwards."""
    return motion.at(t_s if run.opened_s is None else motion.duration_s - t_s).q[0]


def _arrived(run: PickRun) -> PickRun:
    """What follows a motion."""
    if run.leg is Leg.TUCK:
        return replace(run, leg=None, idle_s=0.0)
    if run.leg is Leg.REACH:
        return replace(run, leg=Leg.CLOSE_IN, motion_s=0.0, idle_s=0.0)
    if run.leg is Leg.CLOSE_IN:
        return _next(run, Stage.CLAMP, None)
    if run.leg is Leg.RETREAT:
        return _next(run, Stage.BOX, Leg.LOWER)
    if run.opened_s is not None:
        return replace(run, done=True)
    return replace(run, leg=None, opened_s=run.stage_s, idle_s=0.0)


def _next(run: PickRun, stage: Stage, leg: Leg | None) -> PickRun:
    return replace(run, stage=stage, leg=leg, motion_s=0.0, stage_s=0.0, idle_s=0.0)


def _waited(run: PickRun, dt_s: float, progress: bool, state: RobotState, config: RobotConfig) -> PickRun:
    run = replace(run, idle_s=0.0 if progress else run.idle_s + dt_s)
    if run.idle_s <= config.pick.patience_s:
        return run
    why = next((code for code in state.reasons if code.startswith(("hold.", "stop.", "contact."))), None)
    told = f" ({why})" if why else ""
    return _failed(run, RobotReason.PICK_BLOCKED, f"the robot does not get any further{told}; clear the way")


def _failed(run: PickRun, reason: RobotReason, detail: str) -> PickRun:
    return replace(run, failure=Refusal(reason, detail))


def _status(run: PickRun, state: RobotState) -> str:
    return state.fruits.get(run.plan.fruit, "hanging")


def _held(run: PickRun, state: RobotState) -> bool:
    return _status(run, state).startswith("held")


def progress(run: PickRun) -> float:
    """Share 0..1 of the pick that is done, by the time that each part takes."""
    if run.done:
        return 1.0
    k = STAGES.index(run.stage)
    done_s = sum(run.parts_s[:k]) + min(run.stage_s, run.parts_s[k])
    return min(0.99, done_s / sum(run.parts_s))


def _parts_s(plan: PickPlan, rise_m: float, config: RobotConfig) -> tuple[float, ...]:
    """About how long every stage takes [s], in the order of STAGES."""
    length = {leg: motion.duration_s for leg, motion in plan.motions.items()}
    place_s = max(abs(plan.drive_m) / config.pick.drive_m_s, abs(rise_m) / config.body.lift.speed, 0.01)
    return (
        length.get(Leg.TUCK, 0.0) + place_s,
        length[Leg.REACH] + length[Leg.CLOSE_IN],
        JAW_S,
        config.pick.hold_s,
        BLADE_S,
        length[Leg.RETREAT],
        2.0 * length[Leg.LOWER] + FALL_S,
    )
