"""A pick under way: stage by stage with an ideal robot, every way to fail, and in the real physics."""

from __future__ import annotations

from itertools import pairwise

import pytest
from ideal_robot import IdealRobot
from test_pick_plan import CONFIG, SCENERY, standing

from robot_sim.commands import RobotCommand
from robot_sim.config import GreenhouseConfig, RobotConfig
from robot_sim.pick.plan import PickPlan, Scenery, plan_pick
from robot_sim.pick.run import STAGES, PickRun, Stage, begin, hold, progress, step
from robot_sim.pick.surroundings import hard
from robot_sim.pick.targets import nearest_ripe
from robot_sim.reasons import RobotReason
from robot_sim.world import World

FRUIT = "cucumber_3_fruit_0"
FRAME_S = 1.0 / 30.0


def ideal(name: str = FRUIT, **fate: bool) -> tuple[PickRun, IdealRobot]:
    state = standing()
    plan = plan_pick(name, SCENERY, state, CONFIG)
    assert isinstance(plan, PickPlan)
    return begin(plan, state, CONFIG), IdealRobot(state, CONFIG, name, **fate)  # type: ignore[arg-type]


def play(run: PickRun, robot: IdealRobot, frames: int = 1500) -> tuple[PickRun, list[Stage], list[float]]:
    stages, shares = [run.stage], [0.0]
    for _ in range(frames):
        run, command = step(run, SCENERY, robot.state, CONFIG)
        if run.stage is not stages[-1]:
            stages.append(run.stage)
        shares.append(progress(run))
        if run.over:
            break
        robot.follow(command)
    return run, stages, shares


def test_all_stages_come_in_order_and_progress_only_grows() -> None:
    run, stages, shares = play(*ideal())
    assert run.done and run.failure is None
    assert stages == list(STAGES)
    assert shares[-1] == 1.0
    assert all(b >= a for a, b in pairwise(shares))


def test_tools_work_only_in_their_stages() -> None:
    run, robot = ideal()
    at: dict[Stage, set[tuple[bool | None, bool | None]]] = {stage: set() for stage in STAGES}
    for _ in range(1500):
        stage = run.stage
        run, command = step(run, SCENERY, robot.state, CONFIG)
        at[stage if run.over else run.stage].add((command.gripper_open, command.cutter_closed))
        if run.over:
            break
        robot.follow(command)
    cutting = {stage for stage, told in at.items() if any(closed for _, closed in told)}
    opening = {stage for stage, told in at.items() if any(opened for opened, _ in told)}
    assert cutting <= {Stage.CUT, Stage.RETREAT} and Stage.CUT in cutting
    assert opening <= {Stage.ALIGN, Stage.APPROACH, Stage.CLAMP, Stage.BOX}
    assert not any(opened for opened, _ in at[Stage.RETREAT] | at[Stage.CUT] | at[Stage.HOLD])


@pytest.mark.parametrize(
    ("fate", "reason", "stage"),
    [
        ({"grips": False}, RobotReason.PICK_NOT_GRIPPED, Stage.CLAMP),
        ({"cuts": False}, RobotReason.NOTHING_CUT, Stage.CUT),
        ({"slips": True}, RobotReason.PICK_LOST, Stage.RETREAT),
        ({"boxes": False}, RobotReason.PICK_NOT_BOXED, Stage.BOX),
        ({"stuck": True}, RobotReason.PICK_BLOCKED, Stage.APPROACH),
    ],
)
def test_what_goes_wrong_ends_the_pick_with_its_reason(
    fate: dict[str, bool], reason: RobotReason, stage: Stage
) -> None:
    run, robot = ideal(**fate)
    run, _, _ = play(run, robot)
    assert run.failure is not None and not run.done
    assert (run.failure.reason, run.stage) == (reason, stage)
    assert run.failure.detail


def test_a_held_pick_goes_on_where_it_was() -> None:
    run, robot = ideal()
    for _ in range(90):
        run, command = step(run, SCENERY, robot.state, CONFIG)
        robot.follow(command)
    before = run
    for _ in range(60):
        run = hold(run, robot.state)
        robot.follow(RobotCommand(t_ns=0))
    assert (run.stage, run.leg, run.motion_s, run.idle_s) == (
        before.stage,
        before.leg,
        before.motion_s,
        before.idle_s,
    )
    run, _, _ = play(run, robot)
    assert run.done


def picked(config: RobotConfig, name: str | None, seed: int = 0) -> tuple[World, PickRun, set[str], str]:
    """A pick in the real world; name None: the nearest ripe fruit."""
    world = World(config, seed)
    scenery, state = Scenery(hard(world.scenery()), world.fruits), world.state()
    found = plan_pick(name, scenery, state, config) if name else nearest_ripe(scenery, state, config)[1]
    assert isinstance(found, PickPlan), found
    run, kinds = begin(found, state, config), set[str]()
    for _ in range(600):
        run, command = step(run, scenery, state, config)
        state = world.step(command, FRAME_S)
        kinds |= {str(event.kind) for event in world.events}
        if run.over:
            break
    return world, run, kinds, found.fruit


@pytest.mark.parametrize("name", ["cucumber_2_fruit_0", "cucumber_1_fruit_1"])
def test_a_cucumber_ends_in_the_box_of_the_real_robot(name: str) -> None:
    world, run, kinds, _ = picked(RobotConfig(), name)
    metrics, state = world.metrics(), world.state()
    assert run.done, run.failure
    assert state.fruits == {name: "boxed"}
    assert (metrics.picked, metrics.dropped, metrics.damaged, metrics.cut) == (1, 0, 0, 1)
    assert metrics.arm_contacts == metrics.obstacle_contacts == 0
    assert kinds == {"cut", "boxed"}
    assert metrics.time_s < 12.0
    world.close()


@pytest.mark.parametrize("crop", ["tomato", "grape"])
def test_tomatoes_and_grapes_end_in_the_box_with_the_soft_gripper(crop: str) -> None:
    config = RobotConfig(
        greenhouse=GreenhouseConfig(left_crop=crop, right_crop="cucumber"),  # type: ignore[arg-type]
        tool=CONFIG.tool.model_copy(update={"gripper": "soft"}),
    )
    world, run, _, name = picked(config, None)
    assert run.done, run.failure
    assert world.state().fruits == {name: "boxed"}
    world.close()


def test_the_same_pick_twice_is_the_same_to_the_bit() -> None:
    ends = []
    for _ in range(2):
        world, _, _, _ = picked(RobotConfig(), "cucumber_2_fruit_0", seed=0)
        ends.append(world.state())
        world.close()
    assert ends[0] == ends[1]
