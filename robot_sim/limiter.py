"""The robot's own limiter: from what is wanted to set-points that joints and tracks can follow; pure.

Two halves: ``resolve`` reads a command once (range, NaN, locks) into goals, ``advance`` moves the set-points one
tick towards them with bounded speed and acceleration; ``limit`` is both. ``None`` in a command keeps the goal a joint
has: one request moves the lift all the way. Standing still (stop, emergency stop) drops the goals and brakes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from math import copysign, isfinite

import numpy as np
import numpy.typing as npt

from robot_sim.actuators import JOINT_INDEX, JOINTS, axes
from robot_sim.arm_angles import arm_joint_names, joint_rad
from robot_sim.braking import brakes_clear, braking_margins_m
from robot_sim.clearance import TRUNK, WORKSPACE, breaches, margins_m
from robot_sim.commands import ARM_NAMES, Liquid, RobotCommand
from robot_sim.config import RobotConfig
from robot_sim.profiles import advance_joints, joint_limits
from robot_sim.reasons import RobotReason

F64 = npt.NDArray[np.float64]
_AT_REST = 1e-9


@dataclass(frozen=True, slots=True)
class Setpoints:
    """What the motors follow now, one value per robot_sim.actuators.JOINTS.

    position, velocity: [rad or m, per second]. goal: where the joint is bound for; None, to stand still.
    """

    position: tuple[float, ...]
    velocity: tuple[float, ...]
    goal: tuple[float | None, ...]
    drive_m_s: float = 0.0
    turn_rad_s: float = 0.0
    gripper_open: bool = True
    cutter_closed: bool = False
    spray_on: bool = False
    liquid: Liquid = Liquid.WATER
    sweep_sign: float = 1.0
    estop: bool = False


@dataclass(frozen=True, slots=True)
class Goals:
    """A command inside the limits. position: one per joint, None = as before. reasons: what was changed."""

    position: tuple[float | None, ...]
    drive_m_s: float
    turn_rad_s: float
    gripper_open: bool | None
    cutter_closed: bool | None
    spray_on: bool
    liquid: Liquid | None
    sweep: bool
    stand_still: bool
    reasons: tuple[str, ...]


def home_setpoints(config: RobotConfig) -> Setpoints:
    """Arms hanging down, gripper open, everything at rest."""
    home = tuple(axis.home for axis in axes(config))
    return Setpoints(position=home, velocity=(0.0,) * len(home), goal=(None,) * len(home))


def limit(
    previous: Setpoints, wanted: RobotCommand, dt_s: float, config: RobotConfig
) -> tuple[Setpoints, tuple[str, ...]]:
    """One tick of ``dt_s`` seconds towards a command: new set-points and the reason codes of every change."""
    return advance(previous, resolve(wanted, config), dt_s, config)


def resolve(wanted: RobotCommand, config: RobotConfig) -> Goals:
    """Clamp a command to joint ranges and chassis speeds; a value that is not a finite number counts as a hold."""
    reasons: dict[str, None] = {}
    goal: list[float | None] = [None] * len(JOINT_INDEX)
    asked: dict[str, float] = {}
    for arm in ARM_NAMES:
        if (target := wanted.arm(arm)) is None:
            continue
        if all(isfinite(getattr(target, f.name)) for f in fields(target)):
            asked |= joint_rad(target, arm)
        else:
            reasons[RobotReason.NOT_A_NUMBER] = None
    for name, value in (("lift", wanted.lift_m), ("disc", wanted.disc_rad)):
        if value is None:
            continue
        if isfinite(value):
            asked[name] = value
        else:
            reasons[RobotReason.NOT_A_NUMBER] = None
    jaw, cutter = config.tool.jaw, config.tool.cutter
    if wanted.gripper_open is not None:
        asked |= dict.fromkeys(("gripper_left", "gripper_right"), jaw.upper if wanted.gripper_open else jaw.lower)
    if wanted.cutter_closed is not None:
        asked["cutter"] = cutter.upper if wanted.cutter_closed else cutter.lower
    all_axes = axes(config)
    for name, value in asked.items():
        i = JOINT_INDEX[name]
        limits = all_axes[i].limits
        inside = min(max(value, limits.lower), limits.upper)
        goal[i] = inside
        # less than a tenth of a degree is rounding
        if abs(value - inside) > 1e-3:
            reasons[RobotReason.JOINT_LIMIT] = None
    speeds = []
    for value, most in (
        (wanted.drive_m_s, config.chassis.drive_m_s),
        (wanted.turn_rad_s, config.chassis.turn_rad_s),
    ):
        if not isfinite(value):
            reasons[RobotReason.NOT_A_NUMBER] = None
        elif abs(value) > most:
            reasons[RobotReason.CHASSIS_SPEED] = None
        speeds.append(min(max(value, -most), most) if isfinite(value) else 0.0)
    return Goals(
        position=tuple(goal),
        drive_m_s=speeds[0],
        turn_rad_s=speeds[1],
        gripper_open=wanted.gripper_open,
        cutter_closed=wanted.cutter_closed,
        spray_on=wanted.spray_on,
        liquid=wanted.liquid,
        sweep=wanted.head_camera_sweep,
        stand_still=wanted.stand_still,
        reasons=tuple(reasons),
    )


_DISC, _PAN = JOINT_INDEX["disc"], JOINT_INDEX["head_pan"]
_LOCKED_BY_DISC = tuple(
    i for name, i in JOINT_INDEX.items() if name not in ("lift", "disc", "head_pan") and not name.startswith("gripper")
)
"""Arms and cutter stand still while the disc turns; the gripper keeps what it holds."""


def advance(previous: Setpoints, goals: Goals, dt_s: float, config: RobotConfig) -> tuple[Setpoints, tuple[str, ...]]:
    """Move the set-points by one tick; speeds, accelerations and locks hold whatever the goals are."""
    reasons = dict.fromkeys(goals.reasons)
    still = goals.stand_still or previous.estop
    goal: list[float | None] = [None] * len(JOINTS)
    if not still:
        goal = [kept if new is None else new for new, kept in zip(goals.position, previous.goal, strict=True)]
    turning = _disc_turns(previous, goal[_DISC], config)
    sweep_sign = previous.sweep_sign
    goal[_PAN] = None
    if goals.sweep and not still:
        span = config.body.head_pan
        if previous.position[_PAN] >= span.upper - _AT_REST:
            sweep_sign = -1.0
        elif previous.position[_PAN] <= span.lower + _AT_REST:
            sweep_sign = 1.0
        goal[_PAN] = span.upper if sweep_sign > 0.0 else span.lower
    followed = list(goal)
    if turning:
        for i in _LOCKED_BY_DISC:
            followed[i] = None
        reasons[RobotReason.DISC_TURNING] = None
    if previous.estop:
        reasons[RobotReason.ESTOP] = None
    position, velocity, held = _advance_clear(previous, followed, dt_s, config)
    reasons |= dict.fromkeys(held)
    if (np.abs(velocity) >= joint_limits(config).speed - _AT_REST).any():
        reasons[RobotReason.JOINT_SPEED] = None
    locked = turning or still
    drive, turn = _advance_chassis(previous, goals, dt_s, config, reasons)
    setpoints = Setpoints(
        position=tuple(position.tolist()),
        velocity=tuple(velocity.tolist()),
        goal=tuple(goal),
        drive_m_s=drive,
        turn_rad_s=turn,
        gripper_open=previous.gripper_open if goals.gripper_open is None or still else goals.gripper_open,
        cutter_closed=previous.cutter_closed if goals.cutter_closed is None or locked else goals.cutter_closed,
        spray_on=goals.spray_on and not locked,
        liquid=goals.liquid or previous.liquid,
        sweep_sign=sweep_sign,
        estop=previous.estop,
    )
    return setpoints, tuple(reasons)


def _disc_turns(previous: Setpoints, goal_rad: float | None, config: RobotConfig) -> bool:
    """Whether the disc is under way or about to be."""
    under_way = abs(previous.velocity[_DISC]) > _AT_REST
    return under_way or (goal_rad is not None and abs(goal_rad - previous.position[_DISC]) > config.disc_still_rad)


_ARM_JOINTS = tuple(tuple(JOINT_INDEX[name] for name in arm_joint_names(arm)) for arm in ARM_NAMES)
_ARMS = np.array(_ARM_JOINTS).ravel()
_TOO_NEAR = {TRUNK: RobotReason.BODY_DISTANCE, WORKSPACE: RobotReason.WORKSPACE}


def _advance_clear(
    previous: Setpoints, bound_for: Sequence[float | None], dt_s: float, config: RobotConfig
) -> tuple[F64, F64, tuple[RobotReason, ...]]:
    """One tick towards the goals after which all arms can still brake without coming too near; else some brake now.

    First the arms concerned brake, then, if that does not do, all of them: that way was looked at a tick ago, so the
    arms never come nearer than the configured gaps. Returns positions and speeds (n,), and why arms were held.
    """
    p, v = np.array(previous.position), np.array(previous.velocity)
    followed = np.array([np.nan if goal is None else goal for goal in bound_for])
    position, velocity = advance_joints(p, v, followed, dt_s, config)
    reasons: dict[RobotReason, None] = {}
    held: set[int] = set()
    while len(held) < len(_ARM_JOINTS) and velocity[_ARMS].any():
        if brakes_clear(position[_ARMS], velocity[_ARMS], config):
            break
        after = braking_margins_m(position[_ARMS], velocity[_ARMS], config)
        pairs = breaches(margins_m(p[_ARMS], config), after, config)
        if not pairs:
            break
        reasons |= {_TOO_NEAR.get(b, RobotReason.ARM_DISTANCE): None for _, b in pairs}
        concerned = {arm for pair in pairs for arm in pair if arm >= 0}
        held |= concerned if concerned - held else set(range(len(_ARM_JOINTS)))
        for arm in held:
            followed[list(_ARM_JOINTS[arm])] = np.nan
        position, velocity = advance_joints(p, v, followed, dt_s, config)
    return position, velocity, tuple(reasons)


def latch_estop(previous: Setpoints, on: bool) -> Setpoints:
    """Set or reset the emergency stop; while it is set no goal is followed."""
    return replace(previous, estop=on)


def _advance_chassis(
    previous: Setpoints, goals: Goals, dt_s: float, config: RobotConfig, reasons: dict[str, None]
) -> tuple[float, float]:
    """Drive and turn speeds with bounded acceleration; a stop brakes harder than driving does, an e-stop hardest."""
    chassis = config.chassis
    estop = previous.estop
    pairs = (
        (previous.drive_m_s, goals.drive_m_s, chassis.drive_m_s2, chassis.estop_m_s2 if estop else chassis.stop_m_s2),
        (
            previous.turn_rad_s,
            goals.turn_rad_s,
            chassis.turn_rad_s2,
            chassis.estop_rad_s2 if estop else chassis.stop_rad_s2,
        ),
    )
    stopping = estop or goals.stand_still
    speeds = []
    for now, goal, rate, stop_rate in pairs:
        goal, rate = (0.0, stop_rate) if stopping else (goal, rate)
        step = rate * dt_s
        if abs(goal - now) > step:
            reasons[RobotReason.CHASSIS_ACCELERATION] = None
            goal = now + copysign(step, goal - now)
        speeds.append(goal)
    return speeds[0], speeds[1]
