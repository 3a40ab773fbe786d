"""What the safety kernel remembers and what it must know of a frame."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from robot_sim.commands import ArmName
from robot_sim.posture import Posture, posture
from teleop.assist.step import AssistState
from teleop.assist.task import RobotView
from teleop.config.intent import IntentConfig
from teleop.intent_types import Event, Mode
from teleop.mapping import ArmMemory, eased_from
from teleop.skeleton import Skeleton
from teleop.tools import ToolState


def _resting_arms() -> dict[ArmName, ArmMemory]:
    return {"right": ArmMemory(), "left": ArmMemory(), "rear": ArmMemory()}


@dataclass(frozen=True, slots=True)
class KernelState:
    """What was commanded last. disc_wait_s: the disc still turns for so long, arms and tools stay locked.

    disc_rad: where the disc was sent, None when it was stopped on its way. acting: the mode let the robot move.
    Where the robot really stands (``Moment.posture``) replaces it whenever motion begins.
    """

    task: Mode | None = None
    arms: dict[ArmName, ArmMemory] = field(default_factory=_resting_arms)
    tools: ToolState = field(default_factory=ToolState)
    disc_rad: float | None = 0.0
    disc_wait_s: float = 0.0
    acting: bool = False
    assist: AssistState = field(default_factory=AssistState)
    events: tuple[Event, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """What the kernel must know of this frame beside the intent.

    body: the gated, levelled skeleton, None when it is not tracked right now. dt_s: 0 for a refused frame.
    zone_settled: the operator stands in the zone that counts. robot: as it stands; None: there is none. interrupted:
    the watchdog stopped the robot since the last frame. crossing: the forearms cross, perhaps to stop.
    """

    body: Skeleton | None
    dt_s: float
    zone_settled: bool
    estop: bool
    head_camera_sweep: bool
    robot: RobotView | None = None
    interrupted: bool = False
    crossing: bool = False

    @property
    def posture(self) -> Posture | None:
        """Where the robot's arms and disc are told to be; None without a robot, which then is where it was sent."""
        return posture_of(self.robot)


def posture_of(robot: RobotView | None) -> Posture | None:
    """Where a robot's arms and disc are told to be; None without one."""
    return None if robot is None else posture(robot.state)


def turn_disc(state: KernelState, disc_rad: float, stands: Posture | None, config: IntentConfig) -> KernelState:
    """Send the disc somewhere and lock the arms for as long as it turns."""
    from_rad = state.disc_rad if stands is None else stands.disc_rad
    angle_rad = math.pi if from_rad is None else abs(disc_rad - from_rad)
    wait_s = angle_rad / math.pi * config.mapping.disc_half_turn_s
    return replace(state, disc_rad=disc_rad, disc_wait_s=max(state.disc_wait_s, wait_s))


def ease_anew(state: KernelState, stands: Posture | None) -> KernelState:
    """All arms ease in: from where they stand, or from where they were sent when nobody tells."""
    if stands is not None:
        return replace(state, arms={name: eased_from(stands.arms[name]) for name in state.arms})
    return replace(state, arms={name: replace(memory, easing=True) for name, memory in state.arms.items()})
