"""A world at one moment, as plain numbers, with what PyBullet's own state leaves out: peduncles, tools, spray."""

from __future__ import annotations

from dataclasses import dataclass

from robot_sim.config import RobotConfig
from robot_sim.limiter import Setpoints
from robot_sim.spray import SprayState
from robot_sim.world.body import Motion
from robot_sim.world.crops import FruitStatus
from robot_sim.world.run_log import RunLog
from robot_sim.world.tracks import Heading


@dataclass(frozen=True, slots=True)
class FruitMoment:
    """One fruit: how it lies and moves, whether its peduncle holds."""

    motion: Motion
    attached: bool
    damaged: bool
    status: FruitStatus


@dataclass(frozen=True, slots=True, eq=False)
class Snapshot:
    """Fits every world with the same configuration and seed. joints: position and speed in the order of ALL_JOINTS."""

    config: RobotConfig
    seed: int
    robot: Motion
    joints: tuple[tuple[float, float], ...]
    fruits: tuple[FruitMoment, ...]
    setpoints: Setpoints
    heading: Heading
    spray: SprayState
    ticks: int
    carried_s: float
    blades_closed: bool
    reasons: tuple[str, ...]
    driven: tuple[float, ...]
    log: RunLog
