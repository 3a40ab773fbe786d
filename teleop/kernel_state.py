"""What the safety kernel remembers and what it must know of a frame."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from robot_sim.commands import ArmName
from teleop.assist.step import AssistState
from teleop.assist.task import RobotView
from teleop.config.intent import IntentConfig
from teleop.intent_types import Event, Mode
from teleop.mapping import ArmMemory
from teleop.skeleton import Skeleton
from teleop.tools import ToolState


def _resting_arms() -> dict[ArmName, ArmMemory]:
    return {"right": ArmMemory(), "left": ArmMemory(), "rear": ArmMemory()}


@dataclass(frozen=True, slots=True)
class KernelState:
    """What was commanded last. disc_wait_s: the disc still turns for so long, arms and tools stay locked.

    disc_rad: where the disc was sent, None when it was stopped on its way. acting: the mode let the robot move.
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
    zone_settled: the operator stands in the zone that counts. robot: for the assisted pick; None: there is none.
    """

    body: Skeleton | None
    dt_s: float
    zone_settled: bool
    estop: bool
    head_camera_sweep: bool
    robot: RobotView | None = None


def turn_disc(state: KernelState, disc_rad: float, config: IntentConfig) -> KernelState:
    """Send the disc somewhere and lock the arms for as long as it turns."""
    angle_rad = math.pi if state.disc_rad is None else abs(disc_rad - state.disc_rad)
    wait_s = angle_rad / math.pi * config.mapping.disc_half_turn_s
    return replace(state, disc_rad=disc_rad, disc_wait_s=max(state.disc_wait_s, wait_s))


def ease_anew(state: KernelState) -> KernelState:
    """All arms ease in again from where they were sent last."""
    return replace(state, arms={name: replace(memory, easing=True) for name, memory in state.arms.items()})
