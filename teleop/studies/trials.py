"""One tester at one task: who, before what, until when; and what came of it."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Literal

import numpy as np

from robot_sim.env import GreenhouseEnv, Info
from robot_sim.scenario import Scenario, load_scenario
from robot_sim.spray import canopy
from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config import TeleopConfig
from teleop.evaluation.stills import tester
from teleop.frames import Camera, kinect_v1
from teleop.operator_model.helped_picking import HelpedPicker
from teleop.operator_model.picking import Picker, ready_to_pick
from teleop.operator_model.spraying import Leaves, Sprayer, ready_to_spray
from teleop.operator_model.traits import Traits, traits_of
from teleop.people.performance import Stage
from teleop.people.room import greenhouse_room
from teleop.people.view import sensor_view
from teleop.pipeline import Pipeline
from teleop.sources.virtual_options import SENSOR_HEIGHT_M, SENSOR_TILT_RAD
from teleop.studies.closed_loop import Beat, Mind, play

Task = Literal["pick", "spray", "helped"]
TASKS: Final[tuple[Task, ...]] = ("pick", "spray", "helped")
"""helped: the same pick, pointed at and confirmed; the robot does the rest."""
SCENARIOS: Final[dict[Task, str]] = {"pick": "pick_one", "spray": "spray_square_metre", "helped": "pick_one"}
FRAMES_PER_S: Final = 30.0
OFF_M: Final = (0.10, 0.14)
"""How far before its place the robot stands: one chassis correction."""
LIFT_OFF_M: Final = (0.018, 0.034)
"""How far the lift stands from where a step of the upper arm would fit: 5 to 9.5 degrees of it, half a step is 7.5."""


@dataclass(frozen=True, slots=True)
class TrialSpec:
    """What is to be run. tester: 0 and on. seed: of the tester's errors and of the start. limit_s: then it is over."""

    task: Task
    tester: int
    seed: int
    width: int
    height: int
    limit_s: float = 20.0


@dataclass(frozen=True, slots=True)
class Trial:
    """What came of it. why: empty on success. stages: name to when it began [s]. overspray: share that hit no leaf."""

    task: Task
    tester: int
    success: bool
    time_s: float
    why: str
    off_m: float
    lift_off_m: float
    steps: int
    stages: dict[str, float]
    coverage: float
    sprayed_l: float
    overspray: float
    damaged: int
    dropped: int
    took_s: float


Row = tuple[float, str, str, float, float, float, float, str, str, float]
TRACE_HEADER: Final = (
    "t [s]", "mode", "operator", "robot x [m]", "arm C1 [deg]", "arm C2 [deg]", "arm elbow [deg]",
    "right hand", "left hand", "coverage",
)  # fmt: skip


def started(spec: TrialSpec) -> Scenario:
    """The task's scenario with this tester's start."""
    scenario = load_scenario(SCENARIOS[spec.task])
    rng = np.random.default_rng([71, spec.seed, spec.tester, TASKS.index(spec.task)])
    off_m, lift_m, sign = rng.uniform(*OFF_M), rng.uniform(*LIFT_OFF_M), rng.choice([-1.0, 1.0])
    lift_off_m = 0.0 if spec.task == "spray" else float(sign * lift_m)
    return scenario.model_copy(
        update={"start": scenario.start.model_copy(update={"off_m": float(off_m), "lift_off_m": lift_off_m})}
    )


def mind_of(spec: TrialSpec, scenario: Scenario, env: GreenhouseEnv, traits: Traits) -> Mind:
    """The operator told what to do: which fruit, or which piece of the row."""
    if spec.task != "spray":
        assert scenario.start.beside_fruit is not None
        scenery = {part.name: part for part in env.world.scenery()}
        mind = Picker if spec.task == "pick" else HelpedPicker
        return mind(traits, scenario.start.beside_fruit, scenario.robot, scenery, ready_to_pick(traits))
    goal, drawn = scenario.goal, canopy([part for part in env.world.scenery() if "_leaf_" in part.name])
    assert goal.liquid_kind is not None
    inside = np.flatnonzero(((drawn.middle_m >= goal.low_m) & (drawn.middle_m <= goal.high_m)).all(axis=1))
    leaves = Leaves(tuple(drawn.names[i] for i in inside), drawn.middle_m[inside], drawn.area_m2[inside])
    middle_x_m = 0.5 * (goal.low_m[0] + goal.high_m[0])
    return Sprayer(traits, leaves, goal.liquid_kind, middle_x_m, scenario.robot, ready_to_spray(traits))


@lru_cache(maxsize=1)
def _tracker() -> BodyTracker:
    return BodyTracker(load_model(), TeleopConfig().body)


def beats(spec: TrialSpec, env: GreenhouseEnv, traits: Traits) -> Iterator[Beat]:
    """The whole chain, from 1.5 s before the word go on, without an end. Raises DataError without the people's data."""
    camera = Camera(kinect_v1(spec.width, spec.height))
    pipeline = Pipeline(_tracker(), TeleopConfig())
    pipeline.tracker.warm_up(camera)
    person, view = tester(spec.tester), sensor_view(SENSOR_HEIGHT_M, SENSOR_TILT_RAD)
    noise = 1000 * spec.seed + spec.tester
    stage = Stage(person.body, person.worn, greenhouse_room(spec.tester), view, camera, seed=noise)
    return play(stage, traits, mind_of(spec, env.scenario, env, traits), pipeline, env)


def run_trial(spec: TrialSpec, trace: list[Row] | None = None) -> Trial:
    """One tester until the goal, a spoilt fruit or the time limit. trace: gets a row a frame."""
    began_s = time.monotonic()
    scenario = started(spec)
    traits = traits_of(spec.tester, spec.seed)
    stages: dict[str, float] = {}
    with GreenhouseEnv(scenario, period_s=1.0 / FRAMES_PER_S) as env:
        for beat in beats(spec, env, traits):
            if beat.t_s < -1e-9:
                continue
            stages.setdefault(str(beat.mind.stage), round(beat.t_s, 3))
            if trace is not None:
                trace.append(trace_row(spec.task, beat))
            time_s = beat.t_s + 1.0 / FRAMES_PER_S
            if beat.info.success or spoilt(beat.info) or time_s >= spec.limit_s:
                break
    m, start = beat.info.metrics, scenario.start
    why = failure(spec, beat, time_s)
    return Trial(
        task=spec.task,
        tester=spec.tester,
        success=not why,
        time_s=round(time_s, 3),
        why=why,
        off_m=round(start.off_m, 4),
        lift_off_m=round(start.lift_off_m, 4),
        steps=beat.mind.steps,
        stages=stages,
        coverage=round(beat.coverage, 4),
        sprayed_l=round(sum(m.sprayed_l.values()), 4),
        overspray=round(m.overspray, 4),
        damaged=m.damaged,
        dropped=m.dropped,
        took_s=round(time.monotonic() - began_s, 1),
    )


def spoilt(info: Info) -> bool:
    """Whether a fruit is bruised, torn off or on the floor."""
    return info.metrics.damaged > 0 or info.metrics.dropped > 0


def failure(spec: TrialSpec, beat: Beat, time_s: float) -> str:
    """Why a trial failed, in words; empty when it did not. A fruit in the box counts only whole and cut."""
    m = beat.info.metrics
    if m.damaged:
        return "a fruit was damaged"
    if m.dropped:
        return "a fruit fell on the floor"
    if beat.info.success and spec.task != "spray" and m.cut == 0:
        return "the fruit was torn off, not cut"
    if beat.info.success:
        return ""
    return f"not done after {time_s:.0f} s, while the operator was at: {beat.mind.stage}"


def trace_row(task: Task, beat: Beat) -> Row:
    """One frame for the CSV: the driven arm's set-points, what the hands were read as."""
    command, hands = beat.output.command, beat.output.intent.hands
    arm = command.rear_arm if task == "spray" else command.right_arm
    c1, c2, elbow = (np.nan,) * 3 if arm is None else (arm.c1_deg, arm.c2_deg, arm.elbow_deg)
    return (
        round(beat.t_s, 3), str(beat.output.intent.mode), str(beat.mind.stage), round(beat.robot.base_x_m, 4),
        c1, c2, elbow, str(hands.right), str(hands.left), round(beat.coverage, 4),
    )  # fmt: skip
