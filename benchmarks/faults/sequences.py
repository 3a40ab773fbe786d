"""Random sequences of people, garbage, stamps, buttons and requests, through pipeline and limiter: nothing may break.

Hypothesis draws them and shrinks what fails; the body tracker and PyBullet, which a sequence cannot afford, stand
aside: skeletons are put in where the tracker gives them out, and set-points are taken where the motors follow them.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

sys.path.append(str(Path(__file__).parents[2] / "tests" / "support"))

from scripted import PERIOD_NS, Rig, engaged, rig
from stick_figure import BESIDE_HEAD, CROSSED, FISTS, NO_HANDS, OPEN_HANDS, Person, raised

from robot_sim.actuators import JOINT_INDEX, JOINTS, axes
from robot_sim.arm_angles import ARM_AXES
from robot_sim.clearance import margins_m
from robot_sim.commands import ARM_NAMES, ArmTarget, Liquid, RobotCommand
from robot_sim.config import RobotConfig
from robot_sim.limiter import Setpoints, advance, home_setpoints, latch_estop, resolve
from robot_sim.pick.plan import Scenery
from robot_sim.posture import posture
from robot_sim.state import RobotState
from teleop.assist.task import RobotView
from teleop.inputs import Inputs, RobotRequest
from teleop.intent_types import Mode
from teleop.modes import ACTING
from teleop.pipeline import PipelineOutput
from teleop.skeleton import Skeleton

ROBOT: Final = RobotConfig()
TICKS, TICK_S = 4, 1.0 / 120.0
_ARMS: Final = [JOINT_INDEX[f"{arm}_{axis}"] for arm in ARM_NAMES for axis in ARM_AXES]
_GAPS_M: Final = np.array([ROBOT.clearance.arm_gap_m] * 3 + [ROBOT.clearance.body_gap_m] * 3 + [0.0] * 3)
BETWEEN_LOOKS_M: Final = 0.0005
"""The limiter looks at the braking way in steps; between two of them a gap may be this much smaller."""

Step = tuple[Person | Skeleton | None, int, int, Inputs, bool]
PEOPLE = st.builds(
    Person,
    x=st.floats(-1.2, 1.2),
    z=st.floats(1.0, 4.0),
    right=st.sampled_from([raised(), raised(90), raised(0, 90), raised(150), BESIDE_HEAD, CROSSED]),
    left=st.sampled_from([raised(), raised(60), raised(0, 45), BESIDE_HEAD, CROSSED]),
    legs_apart_deg=st.floats(0, 40),
    stride_deg=st.floats(0, 40),
    hands=st.sampled_from([NO_HANDS, OPEN_HANDS, FISTS]),
)
AT_WORK = st.builds(
    Person,
    right=st.builds(raised, st.floats(0, 180)) | st.builds(raised, st.just(0.0), st.floats(1, 180)),
    left=st.builds(raised, st.floats(0, 180)) | st.builds(raised, st.just(0.0), st.floats(1, 180)),
    legs_apart_deg=st.sampled_from([0.0, 25.0]),
    hands=st.sampled_from([NO_HANDS, OPEN_HANDS, FISTS]),
)
GARBAGE = st.one_of(
    st.sampled_from([np.nan, np.inf, 0.0, 1e6]).map(lambda v: Skeleton(0, np.full((20, 3), v), np.ones(20))),
    st.integers(0, 2**31).map(
        lambda seed: Skeleton(0, np.random.default_rng(seed).uniform(-3, 4, (20, 3)), np.ones(20))
    ),
)
ANY = st.floats(allow_nan=True, allow_infinity=True) | st.floats(-400, 400)
SOME_ARM = st.none() | st.builds(ArmTarget, ANY, ANY, ANY) | st.builds(ArmTarget, *[st.floats(-40, 180)] * 3)
REQUESTS = st.builds(
    RobotRequest,
    drive_m_s=st.none() | ANY,
    turn_rad_s=st.none() | ANY,
    right_arm=SOME_ARM,
    left_arm=SOME_ARM,
    rear_arm=SOME_ARM,
    lift_m=st.none() | ANY,
    disc_rad=st.none() | ANY,
    gripper_open=st.none() | st.booleans(),
    cutter_closed=st.none() | st.booleans(),
    spray_on=st.none() | st.booleans(),
    liquid=st.none() | st.sampled_from(Liquid),
)
BUTTONS = st.builds(Inputs, *[st.booleans()] * 4, st.none() | REQUESTS, interrupted=st.booleans())
INPUTS = st.one_of(st.just(Inputs()), st.just(Inputs(engage=True)), st.just(Inputs(engage=True)), BUTTONS)
STAMPS = st.sampled_from([PERIOD_NS, PERIOD_NS, PERIOD_NS, PERIOD_NS, 0, -PERIOD_NS, 10 * PERIOD_NS, 100 * PERIOD_NS])
STEPS = st.tuples(
    st.one_of(PEOPLE, AT_WORK, AT_WORK, AT_WORK, st.none(), GARBAGE),
    st.integers(1, 12),
    STAMPS,
    INPUTS,
    st.sampled_from([False] * 9 + [True]),
)
SEQUENCES = st.lists(STEPS, min_size=1, max_size=12)
STARTS = st.none() | AT_WORK | st.sampled_from([Person(z=1.65), Person(z=3.1), Person(x=-0.65), Person(x=0.65)])
"""Nobody yet, or somebody in control at work or in one of the other zones."""


@dataclass
class Worst:
    """Largest shares of the limits that were used, over all sequences; 1 is the limit. gap_m: least distance less the
    configured one. moved: frames in which an arm or the chassis moved."""

    sequences: int = 0
    frames: int = 0
    moved: int = 0
    speed: float = 0.0
    acceleration: float = 0.0
    chassis: float = 0.0
    gap_m: float = float("inf")

    def add(self, before: Setpoints, now: Setpoints) -> None:
        for axis, q, v, v0 in zip(axes(ROBOT), now.position, now.velocity, before.velocity, strict=True):
            limits = axis.limits
            assert limits.lower - 1e-9 <= q <= limits.upper + 1e-9, f"{axis.name} is out of its range: {q}"
            self.speed = max(self.speed, abs(v) / limits.speed)
            self.acceleration = max(self.acceleration, abs(v - v0) / (limits.acceleration * TICK_S))
        c = ROBOT.chassis
        self.chassis = max(self.chassis, abs(now.drive_m_s) / c.drive_m_s, abs(now.turn_rad_s) / c.turn_rad_s)
        if any(now.velocity[i] for i in _ARMS):
            gaps = margins_m([now.position[i] for i in _ARMS], ROBOT) - _GAPS_M
            self.gap_m = min(self.gap_m, float(gaps.min()))
        assert self.speed <= 1 + 1e-9 and self.acceleration <= 1 + 1e-6 and self.chassis <= 1 + 1e-9, self
        assert self.gap_m >= -BETWEEN_LOOKS_M, self


@dataclass
class Player:
    """One sequence: the pipeline, the robot's set-points, and what must be true of them."""

    worst: Worst
    rig: Rig = field(default_factory=rig)
    robot: Setpoints = field(default_factory=lambda: home_setpoints(ROBOT))
    estop: bool = False

    def play(self, start: Person | None, steps: list[Step]) -> None:
        """Every frame of every step. Raises AssertionError at the first thing that must not be."""
        self.worst.sequences += 1
        if start is not None:
            self.rig = engaged(person=start)
        for who, frames, dt_ns, inputs, reset in steps:
            for i in range(frames):
                self._frame(who, dt_ns, inputs if i == 0 else Inputs(), reset and i == 0)

    def _frame(self, who: Person | Skeleton | None, dt_ns: int, inputs: Inputs, reset: bool) -> None:
        told = dict(zip(JOINTS, self.robot.position, strict=True))
        speeds = (self.robot.drive_m_s, self.robot.turn_rad_s)
        stands = RobotState(0.0, 0.0, 0.0, 0.0, *speeds, told, told, True, False, False, Liquid.WATER, self.estop)
        self.rig.robot = RobotView(stands, ROBOT, Scenery((), ()))
        self.estop = inputs.estop or (self.estop and not inputs.estop_reset)
        before = self.rig.state.kernel
        out = self.rig.show(who, inputs, dt_ns, reset=reset)
        self._check(out, inputs)
        for name, memory in before.arms.items():
            target = out.command.arm(name)
            if target is not None and memory.easing and inputs.request is None and before.task is not None:
                # after an interruption it is eased from where the robot stands, which may lag behind what it was sent
                assert a_step_from(target, memory.target) or a_step_from(target, posture(stands).arms[name])
        self.robot = latch_estop(self.robot, self.estop)
        goals = resolve(out.command, ROBOT)
        for _ in range(TICKS):
            last = self.robot
            self.robot, _ = advance(last, goals, TICK_S, ROBOT)
            self.worst.add(last, self.robot)
        self.worst.frames += 1
        self.worst.moved += bool(self.robot.drive_m_s or self.robot.turn_rad_s or any(self.robot.velocity))

    def _check(self, out: PipelineOutput, inputs: Inputs) -> None:
        command, mode, config = out.command, out.intent.mode, self.rig.pipeline.intent
        assert (mode is Mode.STOPPED) or not self.estop
        if self.estop:
            assert still(command) and command.stand_still
        if mode not in ACTING:
            assert command.reasons, "who holds says why"
            assert inputs.request is not None or still(command)
            return
        assert abs(command.drive_m_s) <= config.drive.forward_m_s and abs(command.turn_rad_s) <= config.drive.turn_rad_s
        for arm in (command.right_arm, command.left_arm, command.rear_arm):
            # an arm that a request left elsewhere eases back into the operator's range
            assert arm is None or all(np.isfinite((arm.c1_deg, arm.c2_deg, arm.elbow_deg)))
        if command.drive_m_s or command.turn_rad_s:
            assert mode in (Mode.FORWARD, Mode.BACK, Mode.LEFT, Mode.RIGHT)
        if mode is not Mode.SPRAYING:
            assert command.rear_arm is None and not command.spray_on
        if mode is not Mode.PICKING:
            assert command.right_arm is None and command.left_arm is None and command.gripper_open is None


def a_step_from(target: ArmTarget, start: ArmTarget) -> bool:
    """Whether a shoulder goes no further than one step of the mapping."""
    return abs(target.c1_deg - start.c1_deg) <= 15 and abs(target.c2_deg - start.c2_deg) <= 15


def still(command: RobotCommand) -> bool:
    """Whether the command moves nothing: chassis and spray off, arms and gripper held."""
    arms = (command.right_arm, command.left_arm, command.rear_arm)
    return (
        command.drive_m_s == command.turn_rad_s == 0.0
        and not command.spray_on
        and not command.cutter_closed
        and arms == (None, None, None)
        and command.gripper_open is None
    )


def play_sequences(count: int) -> Worst:
    """So many random sequences. Raises AssertionError with the smallest one that breaks a limit."""
    worst = Worst()

    @settings(max_examples=count, suppress_health_check=list(HealthCheck), deadline=None, database=None)
    @given(STARTS, SEQUENCES)
    def run(start: Person | None, steps: list[Step]) -> None:
        Player(worst).play(start, steps)

    run()
    return worst
