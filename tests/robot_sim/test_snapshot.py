"""Snapshots: a restored world goes on exactly as it did, a cut peduncle grown back."""

from __future__ import annotations

import pytest

from robot_sim.commands import ArmTarget, RobotCommand
from robot_sim.errors import RobotError
from robot_sim.state import RobotState
from robot_sim.world import World

FRAME_S = 1.0 / 30.0


def run(world: World, frames: int, **command: object) -> list[RobotState]:
    return [world.step(RobotCommand(t_ns=0, **command), FRAME_S) for _ in range(frames)]  # type: ignore[arg-type]


def busy(world: World) -> list[RobotState]:
    states = run(world, 20, drive_m_s=0.4, turn_rad_s=0.3, right_arm=ArmTarget(70, 10, 120))
    states += run(world, 20, left_arm=ArmTarget(60, 40, 100), lift_m=0.3)
    return states + run(world, 20, disc_rad=1.0, gripper_open=False, cutter_closed=True)


def test_a_restored_world_repeats_itself_bit_by_bit() -> None:
    world = World(seed=2)
    run(world, 15, drive_m_s=0.5, rear_arm=ArmTarget(40, 0, 120))
    world.step(RobotCommand(t_ns=0), 0.0101)
    kept = world.snapshot()
    at = world.state()
    first = busy(world)
    assert first[-1] != at
    assert world.restore(kept) == at
    assert busy(world) == first
    world.restore(kept)
    assert busy(world) == first
    world.close()
    other = World(seed=2)
    other.restore(kept)
    assert busy(other) == first
    other.close()


def test_a_cut_peduncle_holds_again_after_restore() -> None:
    world = World(seed=2)
    run(world, 10)
    kept = world.snapshot()
    untouched = run(world, 30)
    world.restore(kept)
    # what the blades would do, at every fruit
    for i in range(len(world.fruits)):
        world._crops.detach(i)
    fallen = run(world, 60)[-1]
    assert len(fallen.fruits) == len(world.fruits)
    assert set(fallen.fruits.values()) <= {"dropped", "loose"}
    world.restore(kept)
    assert run(world, 30) == untouched
    assert world.state().fruits == {}
    world.close()


def test_taking_a_snapshot_changes_nothing_one_could_see() -> None:
    world = World(seed=2)
    run(world, 20, drive_m_s=0.4, right_arm=ArmTarget(60, 20, 120))
    before = world.state()
    world.snapshot()
    after = world.state()
    assert after.joint_rad == pytest.approx(before.joint_rad, abs=1e-12)
    assert (after.base_x_m, after.base_y_m) == pytest.approx((before.base_x_m, before.base_y_m), abs=1e-9)
    assert after.target_rad == before.target_rad and after.sim_time_s == before.sim_time_s
    going_on = run(world, 20, drive_m_s=0.4)[-1]
    assert going_on.drive_m_s == pytest.approx(0.4, abs=0.02)
    assert abs(going_on.base_y_m) < 0.005
    world.close()


def test_a_snapshot_of_another_greenhouse_is_refused() -> None:
    world, other = World(seed=2), World(seed=3)
    kept = world.snapshot()
    with pytest.raises(RobotError, match="seed 2, not 3"):
        other.restore(kept)
    world.close()
    other.close()
