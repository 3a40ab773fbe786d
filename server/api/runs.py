"""The run: what it has come to since the robot's last reset, its reset, and the scenarios that come with the robot."""

from __future__ import annotations

from typing import Literal

from fastapi import APIRouter
from pydantic import BaseModel, Field

from robot_sim.metrics import RunMetrics
from robot_sim.scenario import bundled, load_scenario
from server.api.deps import EngineDep, done
from server.api.problems import documented

router = APIRouter(tags=["run"])


class Run(BaseModel):
    """Counted since the last reset (robot_sim.metrics.RunMetrics). Shares are 0..1, liquids by name."""

    time_s: float = Field(description="simulated time [s]")
    distance_m: float = Field(description="driven by the chassis [m]")
    turned_rad: float = Field(description="turned by the chassis, both ways added [rad]")
    energy_j: float = Field(description="mechanical work of all motors [J]")
    picked: int = Field(description="fruit in the box now")
    unripe: int = Field(description="unripe fruit among it")
    dropped: int = Field(description="fruit on the floor now")
    damaged: int = Field(description="damaged fruit")
    cut: int = Field(description="peduncles cut")
    arm_contacts: int = Field(description="how often arms began to touch each other or the trunk")
    obstacle_contacts: int = Field(description="how often the robot ran into something")
    sprayed_l: dict[str, float] = Field(description="by liquid [l]")
    coverage: dict[str, float] = Field(description="wet share of all leaf area, by liquid")
    overspray: float = Field(description="share of the spray that hit no leaf")
    wrong_liquid: float = Field(description="share of the spray that hit a leaf which wants another liquid")


class RunGoal(BaseModel):
    """How far the run is towards its scenario's goal."""

    scenario: str
    reached: bool
    coverage: float = Field(description="wet share of the leaves in the goal's window, with its liquid")
    left_s: float = Field(description="simulated time left of the scenario's limit [s]; below 0: it is over")


class ScenarioRun(Run):
    """The run, and how far it is."""

    goal: RunGoal | None = Field(default=None, description="null without a scenario: teleop serve --scenario NAME")


class ScenarioInfo(BaseModel):
    """A scenario that comes with the robot: ``teleop serve --scenario NAME`` and robot_sim.env play it."""

    name: str
    description: str
    seed: int
    time_limit_s: float
    gripper: Literal["long", "soft"]


async def _run(engine: EngineDep, metrics: RunMetrics) -> ScenarioRun:
    run = ScenarioRun.model_validate(metrics, from_attributes=True)
    played = engine.scenario
    if played is None:
        return run
    wet = await done(engine.goal_coverage())
    run.goal = RunGoal(
        scenario=played.name,
        reached=played.goal.reached(metrics, wet),
        coverage=wet,
        left_s=played.time_limit_s - metrics.time_s,
    )
    return run


@router.get("/run", responses=documented(503))
async def read_run(engine: EngineDep) -> ScenarioRun:
    """Time, fruit, contacts, distance, energy and spray since the last reset."""
    return await _run(engine, await done(engine.metrics()))


@router.post("/run/reset", responses=documented(409, 503))
async def reset_run(engine: EngineDep) -> ScenarioRun:
    """Put the robot and the crop back to their start and count anew; an engaged operator must engage again.

    A latched emergency stop stays. Refused (409) while a recording is made: it could not be replayed.
    """
    return await _run(engine, await done(engine.restart_robot()))


@router.get("/scenarios")
def list_scenarios() -> list[ScenarioInfo]:
    """The scenarios that come with the robot."""
    found = [load_scenario(name) for name in bundled()]
    return [
        ScenarioInfo(
            name=s.name,
            description=s.description,
            seed=s.seed,
            time_limit_s=s.time_limit_s,
            gripper=s.robot.tool.gripper,
        )
        for s in found
    ]
