"""Scenarios: where a run starts and what it is to reach, as TOML; some come with the package. Pure but for reading."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Literal, Self

from pydantic import Field, ValidationError, model_validator

from robot_sim.commands import Liquid
from robot_sim.config import RobotConfig
from robot_sim.errors import RobotError
from robot_sim.metrics import RunMetrics
from robot_sim.section import RobotSection
from robot_sim.standing import PICK_POSE, standing_place
from robot_sim.start_config import Start

__all__ = ["PICK_POSE", "Goal", "Scenario", "Start", "bundled", "load_scenario", "standing_place"]

BUNDLED = Path(__file__).parent / "scenarios"
Vec = tuple[float, float, float]


class Goal(RobotSection):
    """What ends a run well; all that is given must hold."""

    picked: int = Field(default=0, ge=0, le=1000, description="fruit in the box [1]")
    unripe: int | None = Field(default=None, ge=0, description="most unripe fruit among it [1]")
    liquid: Literal["water", "nutrient", "pesticide"] | None = Field(default=None, description="what to spray")
    coverage: float = Field(default=0.0, ge=0.0, le=1.0, description="wet share of the leaf area in the window [1]")
    low_m: Vec = Field(default=(-0.5, 0.4, 0.75), description="one corner of the window, world axes [m]")
    high_m: Vec = Field(default=(0.5, 1.3, 1.75), description="the opposite corner [m]")

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if self.coverage > 0.0 and self.liquid is None:
            raise ValueError("coverage needs a liquid: water, nutrient or pesticide")
        if any(low >= high for low, high in zip(self.low_m, self.high_m, strict=True)):
            raise ValueError("low_m must be below high_m on every axis")
        return self

    def reached(self, metrics: RunMetrics, coverage: float) -> bool:
        """Whether the goal is reached; coverage: of the window, with the goal's liquid. An empty goal never is."""
        if self.picked == 0 and self.coverage == 0.0:
            return False
        ripe = self.unripe is None or metrics.unripe <= self.unripe
        return metrics.picked >= self.picked and ripe and coverage >= self.coverage

    def wet(self, coverage: Callable[[Liquid, Vec, Vec], float]) -> float:
        """Wet share 0..1 of the window, as ``World.coverage`` tells it; 0 for a goal without a liquid."""
        liquid = self.liquid_kind
        return 0.0 if liquid is None else coverage(liquid, self.low_m, self.high_m)

    @property
    def liquid_kind(self) -> Liquid | None:
        """The liquid as the robot takes it."""
        return None if self.liquid is None else Liquid(self.liquid)


class Scenario(RobotSection):
    """One run: greenhouse, start, goal, time."""

    name: str = Field(min_length=1, max_length=60, pattern=r"^[a-z0-9_]+$", description="what it is called")
    description: str = Field(default="", max_length=400, description="what is to be done")
    seed: int = Field(default=0, ge=0, le=2**31, description="decides the crop")
    time_limit_s: float = Field(default=120.0, gt=0.0, le=36000.0, description="simulated time it may take [s]")
    start: Start = Field(default_factory=Start)
    goal: Goal = Field(default_factory=Goal)
    robot: RobotConfig = Field(default_factory=RobotConfig)

    @property
    def robot_config(self) -> RobotConfig:
        """The robot with its place at the start."""
        return self.robot.model_copy(update={"start": self.start})


def bundled() -> tuple[str, ...]:
    """Names of the scenarios that come with the package."""
    return tuple(sorted(path.stem for path in BUNDLED.glob("*.toml")))


def load_scenario(name_or_path: str) -> Scenario:
    """A bundled scenario by name, or a TOML file. Raises RobotError with one line that says what is legal."""
    path = BUNDLED / f"{name_or_path}.toml" if name_or_path in bundled() else Path(name_or_path)
    try:
        tree = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError):
        raise RobotError(f"no scenario '{name_or_path}'; give a TOML file or one of: {', '.join(bundled())}") from None
    except tomllib.TOMLDecodeError as error:
        raise RobotError(f"{path.name} is no TOML: {error}") from None
    try:
        return Scenario.model_validate(tree)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise RobotError(f"{path.name}: {where or 'scenario'}: {first['msg']}") from None
