"""Scenarios and the environment: a scripted pick and a scripted spraying reach their goals, and are counted."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from robot_sim.commands import ArmTarget, RobotCommand
from robot_sim.env import GreenhouseEnv, Info, Observation
from robot_sim.errors import RobotError
from robot_sim.events import RobotEventKind
from robot_sim.scenario import PICK_POSE, bundled, load_scenario, standing_place

BOX_POSE = ArmTarget(30, 0, 135)


def play(env: GreenhouseEnv, seconds: float, **command: object) -> tuple[Observation, Info, bool, set[str]]:
    kinds: set[str] = set()
    for _ in range(round(seconds / env.period_s)):
        seen, _, done, _, info = env.step(RobotCommand(t_ns=0, **command))  # type: ignore[arg-type]
        kinds |= {str(event.kind) for event in info.events}
    return seen, info, done, kinds


def pick(env: GreenhouseEnv) -> tuple[Info, bool, set[str]]:
    """What an operator does: come near, both arms up, grip, cut, let go."""
    fruit = next(f for f in env.world.fruits if f.name == env.scenario.start.beside_fruit)
    x_m, _ = standing_place(fruit, env.scenario.robot)
    while abs(x_m - env.observe().robot.base_x_m) > 0.004:
        play(env, env.period_s, drive_m_s=2.0 * (x_m - env.observe().robot.base_x_m))
    play(env, 0.8, right_arm=PICK_POSE, left_arm=BOX_POSE)
    play(env, 0.5, gripper_open=False)
    _, _, _, cut = play(env, 0.35, cutter_closed=True)
    _, info, done, kinds = play(env, 0.6, gripper_open=True)
    return info, done, cut | kinds


@pytest.mark.parametrize("name", ["pick_one", "pick_grapes"])
def test_a_scripted_pick_reaches_the_goal_and_is_counted(name: str) -> None:
    with GreenhouseEnv(name) as env:
        env.reset()
        info, done, kinds = pick(env)
        assert done and info.success
        m = info.metrics
        assert (m.picked, m.dropped, m.damaged, m.cut) == (1, 0, 0, 1)
        assert {RobotEventKind.CUT, RobotEventKind.BOXED} <= kinds
        assert 1.0 < m.time_s < 12.0 and m.energy_j > 5.0
        assert m.distance_m == pytest.approx(env.scenario.start.off_m, abs=0.02)


def test_a_truss_of_tomatoes_in_the_soft_gripper() -> None:
    with GreenhouseEnv("pick_tomatoes") as env:
        env.reset()
        info, done, _ = pick(env)
        assert (info.metrics.picked, info.metrics.damaged) == (1, 0)
        assert not done, "two are wanted"


def test_a_scripted_sweep_sprays_the_square_metre() -> None:
    with GreenhouseEnv("spray_square_metre") as env:
        env.reset()
        play(env, 3.5, disc_rad=math.pi, rear_arm=ArmTarget(0, 0, 140))
        for c1, elbow in [*((0, 140 - 10 * k) for k in range(6)), (15, 90), (30, 90), (45, 90), (30, 90), (15, 90)]:
            seen, info, done, _ = play(env, 0.5, rear_arm=ArmTarget(c1, 0, elbow), spray_on=True)
        assert done and seen.coverage >= 0.9
        assert info.metrics.sprayed_l["water"] == pytest.approx(5.5 * env.scenario.robot.spray.flow_l_s, rel=0.05)
        assert 0.0 < info.metrics.overspray < 1.0
        assert info.metrics.coverage["water"] > 0.0 == info.metrics.coverage["pesticide"]


def test_same_scenario_same_commands_same_observations() -> None:
    runs = []
    with GreenhouseEnv("pick_one") as env:
        for _ in range(2):
            first, _ = env.reset()
            seen, info, _, _ = play(env, 0.5, drive_m_s=0.2, right_arm=PICK_POSE)
            runs.append((first.robot, seen.robot, info.metrics))
        other, _ = env.reset(seed=4)
    assert runs[0] == runs[1]
    assert other.fruits != seen.fruits


def test_every_bundled_scenario_loads() -> None:
    assert {"pick_one", "spray_square_metre"} <= set(bundled())
    for name in bundled():
        assert load_scenario(name).name == name


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('name = "x"\n[robot.tool]\ngripper = "magnet"', "robot.tool.gripper: Input should be 'long' or 'soft'"),
        ('name = "x"\n[goal]\ncoverage = 0.5', "coverage needs a liquid"),
        ('name = "x"\ncolour = 1', "colour: Extra inputs are not permitted"),
        ("name = ", "is no TOML"),
    ],
)
def test_a_wrong_scenario_is_one_clear_line(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(RobotError, match=r"wrong\.toml") as error:
        load_scenario(str(path))
    assert says in str(error.value) and "\n" not in str(error.value)


def test_wrong_calls_say_what_to_do() -> None:
    with pytest.raises(RobotError, match="one of: pick_grapes, pick_one"):
        GreenhouseEnv("no_such")
    with pytest.raises(RobotError, match="period"):
        GreenhouseEnv("pick_one", period_s=0.0)
    with GreenhouseEnv("pick_one") as env, pytest.raises(RobotError, match="reset"):
        env.step(RobotCommand(t_ns=0))
