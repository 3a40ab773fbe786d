"""One tester through the source's angle experiment: posed and rendered, tracked, sent, reached by the robot's arms.

One arm goes through every level of four movements: raise, hold, raise on; the other rests. At the end of a hold four
angles are read at the same instant: of the person's own joints, of the tracked ones, of the command, of the robot's
joints.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Literal

import numpy as np

from robot_sim.arm_angles import arm_target
from robot_sim.commands import ArmTarget
from robot_sim.config import GreenhouseConfig, RobotConfig, ServoConfig
from robot_sim.reasons import RobotReason
from robot_sim.world import World
from teleop.angles import body_angles
from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config import TeleopConfig
from teleop.evaluation.poses import PROTOCOL, bent, raised
from teleop.evaluation.stills import tester
from teleop.frames import Camera, kinect_v1
from teleop.inputs import Inputs
from teleop.intent_types import Mode, Side
from teleop.mapping import nearest_step
from teleop.people.motion import ArmKey, Key, Motion
from teleop.people.performance import Stage
from teleop.people.pose import DOWN, FORWARD, unit
from teleop.people.rig import Floats
from teleop.people.room import greenhouse_room
from teleop.people.view import View, sensor_view
from teleop.pipeline import Pipeline
from teleop.skeleton import Skeleton
from teleop.sources.virtual_options import SENSOR_HEIGHT_M, SENSOR_TILT_RAD

Movement = Literal["forward", "sideways", "elbow_forward", "elbow_across"]
MOVEMENTS: Final[tuple[Movement, ...]] = ("forward", "sideways", "elbow_forward", "elbow_across")
FRAMES_PER_S: Final = 10.0
"""Enough for postures that are held; the tracker's filter goes by the frames' time."""
RAISE_S, HOLD_S, READ_S = 0.4, 1.4, 0.25
"""From level to level, at rest there, and the last part of the rest in which angles are read."""
STOOD_S: Final = 0.5
"""A command that has not changed for so long has been followed."""
_START_S: Final = 4.0
"""The operator is seen, the button engages them, the arms ease in."""
_ENGAGE_S: Final = 1.0
_STAND_M: Final = 2.3
_APART_RAD: Final = np.radians(24.0)
"""Legs apart: the task is picking, both arms are the robot's."""
_FRONT: Final = np.array(FORWARD)
_HOLDS: Final = frozenset({RobotReason.WORKSPACE, RobotReason.ARM_DISTANCE, RobotReason.BODY_DISTANCE})
"""Why the robot keeps an arm from where it is sent."""
_SIDES: Final[tuple[tuple[Side, float], ...]] = (("right", 1.0), ("left", -1.0))


@dataclass(frozen=True, slots=True)
class AngleSpec:
    """Which tester, 0 and on, whose errors, which sensor; a part of the movements for a quick look."""

    tester: int
    seed: int
    width: int = 640
    height: int = 480
    movements: tuple[Movement, ...] = MOVEMENTS
    every: int = 1

    def levels(self, movement: Movement) -> tuple[float, ...]:
        """Degrees, in the order in which they are taken: arms are raised, elbows straightened."""
        return PROTOCOL[movement][:: self.every]


@dataclass(frozen=True, slots=True)
class Reading:
    """One instant of one arm [deg]. NaN: no answer, or the arm is not driven. stood: the command has not
    changed for STOOD_S. held: the robot said that it kept an arm
    from where it was sent."""

    tester: int
    movement: Movement
    level: float
    side: Side
    true: float
    captured: float
    sent: float
    reached: float
    stood: bool
    held: bool

    @property
    def is_shoulder(self) -> bool:
        """Whether the angle is sent in steps."""
        return not self.movement.startswith("elbow")

    @property
    def off_edge_deg(self) -> float:
        """How far the true angle lies from the nearest edge between two steps: 7.5, 22.5, ... 82.5 deg."""
        step = TeleopConfig().intent.mapping.step_deg
        return abs(self.true % step - step / 2) if self.true < 90.0 - step / 2 else self.true - (90.0 - step / 2)

    @property
    def ideal(self) -> float:
        """What would be sent of the true angle."""
        return nearest_step(self.true, TeleopConfig().intent.mapping) if self.is_shoulder else self.true


def posed_arm(movement: Movement | None, level: float, sign: float, off_deg: Floats) -> ArmKey:
    """An arm of somebody at a level of a movement; None: at rest. off_deg (4,): how exactly they keep the rest of it.

    Thumbs up, palms to each other, as one raises an arm that is being measured.
    """
    outward = np.array([sign, 0.0, 0.0])
    if movement == "sideways":
        upper = raised(sign, level, off_deg[0])
        fore = bent(upper, 172.0 + 0.5 * off_deg[1], _FRONT)
    elif movement == "forward":
        upper = raised(sign, off_deg[0], level)
        fore = bent(upper, 172.0 + 0.5 * off_deg[1], -np.array(DOWN))
    elif movement == "elbow_across":
        upper = raised(sign, 55.0 + 2 * off_deg[2], off_deg[0])
        # folded downwards: forearms beside the head would be the gesture that disengages
        fore = bent(upper, level, np.array(DOWN) + 0.04 * off_deg[3] * _FRONT)
    else:
        upper = raised(sign, 4.0 + off_deg[0], 5.0 + off_deg[2])
        fore = bent(upper, level if movement else 168.0, _FRONT)
    palm = _FRONT if movement in ("sideways", "elbow_across") else -outward
    return ArmKey(upper, unit(fore), palm, 0.0)


@dataclass(frozen=True, slots=True)
class Rest:
    """A level that is held. from_s: when angles begin to be read, until_s: the end."""

    movement: Movement
    level: float
    from_s: float
    until_s: float


def arm_of(tester: int, movement: Movement) -> Side:
    """Which arm a tester moves: half of them the right one.

    Never both at once: the robot keeps its arms, one with a box and one with a gripper, apart from each other.
    """
    return "right" if (tester + MOVEMENTS.index(movement)) % 2 == 0 else "left"


def protocol(spec: AngleSpec) -> tuple[Motion, tuple[Rest, ...]]:
    """The tester's motion, from before engaging on, and its rests."""
    rng = np.random.default_rng([73, spec.seed, spec.tester])
    x_m = float(rng.uniform(-0.1, 0.1))

    def key(t_s: float, movement: Movement | None, level: float, off_deg: Floats) -> Key:
        right, left = (
            posed_arm(movement if movement and side == arm_of(spec.tester, movement) else None, level, sign, off_deg[k])
            for k, (side, sign) in enumerate(_SIDES)
        )
        return Key(t_s, x_m, _STAND_M, 0.0, right, left, float(_APART_RAD))

    keys, rests, t_s = [key(0.0, None, 0.0, np.full((2, 4), 4.0))], [], _START_S
    keys.append(key(t_s, None, 0.0, np.full((2, 4), 4.0)))
    for movement in spec.movements:
        off_deg = rng.uniform(2.0, 8.0, (2, 4))
        # down and up again takes longer than from level to level
        t_s += 2 * RAISE_S
        for level in spec.levels(movement):
            t_s += RAISE_S
            keys.append(key(t_s, movement, level, off_deg))
            t_s += HOLD_S
            keys.append(key(t_s, movement, level, off_deg))
            rests.append(Rest(movement, level, t_s - READ_S, t_s))
    return Motion(keys, spec.tester), tuple(rests)


def empty_aisle() -> RobotConfig:
    """The robot with servos as they are, and with nothing in the arms' way: the rows as far off as they can be."""
    wide = GreenhouseConfig(row_offset_m=2.0, fruit_offset_m=1.5, leaves_per_plant=0, fruits_per_plant=0)
    return RobotConfig(greenhouse=wide, servo=ServoConfig(whole_degrees=True, backlash_rad=0.01))


@lru_cache(maxsize=1)
def _tracker() -> BodyTracker:
    return BodyTracker(load_model(), TeleopConfig().body)


def read_tester(spec: AngleSpec) -> list[Reading]:
    """The whole experiment of one tester. Raises DataError without the people's data."""
    return list(readings(spec))


def readings(spec: AngleSpec) -> Iterator[Reading]:
    """The moving arm's angles, frame by frame of every rest. Depth alone: colour is only for the hands."""
    camera = Camera(kinect_v1(spec.width, spec.height))
    pipeline = Pipeline(_tracker(), TeleopConfig())
    pipeline.tracker.warm_up(camera)
    person, view = tester(spec.tester), sensor_view(SENSOR_HEIGHT_M, SENSOR_TILT_RAD)
    noise = 1000 * spec.seed + spec.tester
    stage = Stage(person.body, person.worn, greenhouse_room(spec.tester), view, camera, light=None, seed=noise)
    motion, rests = protocol(spec)
    world = World(empty_aisle(), spec.seed)
    try:
        yield from _played(spec, stage, motion, rests, pipeline, world)
    finally:
        world.close()


def _played(
    spec: AngleSpec, stage: Stage, motion: Motion, rests: tuple[Rest, ...], pipeline: Pipeline, world: World
) -> Iterator[Reading]:
    state = pipeline.initial_state()
    due = list(rests)
    targets: deque[dict[Side, ArmTarget | None]] = deque(maxlen=round(STOOD_S * FRAMES_PER_S) + 1)
    for number in range(int(rests[-1].until_s * FRAMES_PER_S) + 1):
        t_s = number / FRAMES_PER_S
        take = stage.take(motion.at(t_s), number, round(t_s * 1e9))
        engage = number == round(_ENGAGE_S * FRAMES_PER_S)
        output, state = pipeline.step(take.frame, state, Inputs(engage=engage))
        robot = world.step(output.command, 1.0 / FRAMES_PER_S)
        driven = output.intent.mode is Mode.PICKING
        command: dict[Side, ArmTarget | None] = {"right": output.command.right_arm, "left": output.command.left_arm}
        targets.append(command if driven else {"right": None, "left": None})
        while due and t_s > due[0].until_s + 1e-9:
            due.pop(0)
        if not due or t_s < due[0].from_s - 1e-9:
            continue
        rest = due[0]
        column = {"forward": 1, "sideways": 0}.get(rest.movement, 2)
        # c1 is driven by theta2, c2 by theta1
        servo = {"forward": 0, "sideways": 1}.get(rest.movement, 2)
        true = true_angles(take.joints_m, stage.view)
        side = arm_of(spec.tester, rest.movement)
        found = output.intent.angles.right if side == "right" else output.intent.angles.left
        captured = (found.theta1_deg, found.theta2_deg, found.theta3_deg)[column]
        sent = [_servo_deg(before[side], servo) for before in targets]
        yield Reading(
            spec.tester,
            rest.movement,
            rest.level,
            side,
            true[side][column],
            np.nan if captured is None else captured,
            sent[-1],
            _servo_deg(arm_target(robot.joint_rad, side), servo),
            len(set(sent)) == 1,
            not _HOLDS.isdisjoint(robot.reasons),
        )


def _servo_deg(arm: ArmTarget | None, servo: int) -> float:
    return float("nan") if arm is None else (arm.c1_deg, arm.c2_deg, arm.elbow_deg)[servo]


def true_angles(joints_m: Floats, view: View) -> dict[Side, tuple[float, float, float]]:
    """theta1, theta2, theta3 [deg] of each arm of joints (20, 3) in camera axes, levelled; NaN where undefined."""
    level = Skeleton(0, (joints_m - view.t_m) @ view.R, np.ones(len(joints_m)))
    angles = body_angles(level, TeleopConfig().intent.angles)
    out: dict[Side, tuple[float, float, float]] = {}
    for (side, _), arm in zip(_SIDES, (angles.right, angles.left), strict=True):
        t1, t2, t3 = (np.nan if a is None else a for a in (arm.theta1_deg, arm.theta2_deg, arm.theta3_deg))
        out[side] = (t1, t2, t3)
    return out
