"""The greenhouse as an environment for programs: reset, step, observe (the signature of gymnasium, without it)."""

from __future__ import annotations

from dataclasses import dataclass
from types import TracebackType
from typing import Self

from robot_sim.commands import RobotCommand
from robot_sim.errors import RobotError
from robot_sim.events import RobotEvent
from robot_sim.metrics import RunMetrics
from robot_sim.plants import Fruit
from robot_sim.scenario import Scenario, load_scenario
from robot_sim.state import RobotState
from robot_sim.world import World


@dataclass(frozen=True, slots=True)
class Observation:
    """robot: what it reports. fruits: all fruit as it grew. coverage: wet share 0..1 of the goal's window."""

    robot: RobotState
    fruits: tuple[Fruit, ...]
    coverage: float


@dataclass(frozen=True, slots=True)
class Info:
    """metrics since the reset, events of the last step, and whether the goal is reached."""

    metrics: RunMetrics
    events: tuple[RobotEvent, ...]
    success: bool


class GreenhouseEnv:
    """One scenario, played by RobotCommands; same scenario, seed and commands, bit-equal observations."""

    def __init__(self, scenario: Scenario | str = "pick_one", period_s: float = 1.0 / 30.0) -> None:
        """scenario: one, or the name of one. period_s: simulated time of one step [s].

        Raises RobotError for a scenario that is not there, a fruit that does not grow there, and a period that is not
        above zero.
        """
        if not 0.0 < period_s <= 1.0:
            raise RobotError(f"the period must be above 0 s and at most 1 s, got {period_s}")
        self.scenario = load_scenario(scenario) if isinstance(scenario, str) else scenario
        self.period_s = period_s
        self._world = World(self.scenario.robot_config, self.scenario.seed)
        self._score = 0.0
        self._ready = False

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def world(self) -> World:
        """The simulation underneath."""
        return self._world

    def reset(self, seed: int | None = None) -> tuple[Observation, Info]:
        """Begin anew, with another crop when a seed is given; returns observation and info."""
        if seed is not None and seed != self._world.seed:
            self._world.close()
            self._world = World(self.scenario.robot_config, seed)
        self._world.reset()
        self._ready = True
        self._score = self._value()
        return self.observe(), self._info()

    def step(self, action: RobotCommand) -> tuple[Observation, float, bool, bool, Info]:
        """Follow a command for one period: observation, reward, terminated, truncated, info.

        reward: growth of fruit picked and window covered, less damage and contacts. terminated: the goal is reached.
        truncated: out of time. Raises RobotError before the first reset.
        """
        if not self._ready:
            raise RobotError("call reset() before the first step()")
        self._world.step(action, self.period_s)
        value = self._value()
        reward, self._score = value - self._score, value
        info = self._info()
        return self.observe(), reward, info.success, info.metrics.time_s >= self.scenario.time_limit_s, info

    def observe(self) -> Observation:
        """What there is to see now; changes nothing."""
        return Observation(self._world.state(), self._world.fruits, self._coverage())

    def close(self) -> None:
        """Free the simulation."""
        self._world.close()

    def _coverage(self) -> float:
        return self.scenario.goal.wet(self._world.coverage)

    def _info(self) -> Info:
        metrics = self._world.metrics()
        return Info(metrics, self._world.events, self.scenario.goal.reached(metrics, self._coverage()))

    def _value(self) -> float:
        m = self._world.metrics()
        harm = m.damaged + m.dropped + m.unripe + m.arm_contacts + m.obstacle_contacts
        return m.picked + self._coverage() - 0.5 * harm
