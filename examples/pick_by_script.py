"""Pick in the simulation without any server: the environment, the planner, and a robot that does what it is told.

python examples/pick_by_script.py pick_one
"""

from __future__ import annotations

import argparse

from robot_sim.env import GreenhouseEnv, Info
from robot_sim.errors import RobotError
from robot_sim.pick.plan import Scenery, plan_pick
from robot_sim.pick.refusal import Refusal
from robot_sim.pick.run import begin, step
from robot_sim.pick.surroundings import hard


def pick(env: GreenhouseEnv, fruit: str) -> Info:
    """Pick one fruit of a scenario that was reset. Raises RobotError when it cannot be picked from there."""
    world, robot = env.world, env.observe().robot
    scenery = Scenery(hard(world.scenery()), world.fruits)
    plan = plan_pick(fruit, scenery, robot, world.config)
    if isinstance(plan, Refusal):
        raise RobotError(f"{fruit} ({plan.reason}): {plan.detail}")
    run = begin(plan, robot, world.config)
    while True:
        run, command = step(run, scenery, robot, world.config)
        seen, _, _, late, info = env.step(command)
        robot = seen.robot
        if run.failure is not None:
            raise RobotError(f"{fruit} ({run.failure.reason}): {run.failure.detail}")
        if run.done or late:
            return info


def main(arguments: list[str] | None = None) -> int:
    """Exit code 1 when the scenario's goal was not reached."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenario", nargs="?", default="pick_one")
    given = parser.parse_args(arguments)
    with GreenhouseEnv(given.scenario) as env:
        env.reset()
        fruit = env.scenario.start.beside_fruit
        if fruit is None:
            raise RobotError(f"{given.scenario} names no fruit to pick; try pick_one, pick_tomatoes or pick_grapes")
        info = pick(env, fruit)
    m = info.metrics
    print(f"{fruit}: {m.picked} in the box, {m.damaged} damaged, {m.time_s:.1f} s, {m.energy_j:.0f} J")
    return 0 if m.picked else 1


if __name__ == "__main__":
    raise SystemExit(main())
