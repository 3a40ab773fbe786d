"""How fast the simulated robot runs with its greenhouse row, and what telling the console of it costs."""

from __future__ import annotations

import math
import time

import numpy as np
from rich.console import Console
from rich.table import Table

from robot_sim.commands import ArmTarget, RobotCommand
from robot_sim.world import World
from server.engine.snapshot import robot_state

FRAME_S = 1.0 / 30.0


def work(frame: int) -> RobotCommand:
    """Arms, lift and chassis all moving: the busiest the robot gets."""
    swing = 45.0 + 40.0 * math.sin(0.2 * frame)
    arm = ArmTarget(swing, 0.4 * swing, 180.0 - swing)
    return RobotCommand(
        t_ns=0,
        drive_m_s=0.2 * math.sin(0.05 * frame),
        turn_rad_s=0.1 * math.cos(0.05 * frame),
        right_arm=arm,
        left_arm=arm,
        lift_m=0.2 + 0.1 * math.sin(0.02 * frame),
        gripper_open=frame % 60 < 30,
    )


def speed(world: World, seconds: float) -> tuple[float, np.ndarray]:
    """Times faster than real time, by processor time of one core; wall seconds of every frame's step."""
    took = []
    begin_cpu = time.process_time()
    for frame in range(round(seconds / FRAME_S)):
        begin = time.perf_counter()
        world.step(work(frame), FRAME_S)
        took.append(time.perf_counter() - begin)
    return seconds / (time.process_time() - begin_cpu), np.array(took)


def telling(world: World, frames: int) -> float:
    """Share of one core that reading, packing and encoding the robot's state takes at 30 Hz, fruit moved and all."""
    for i in range(0, len(world.fruits), 2):
        world._crops.detach(i)
    state = world.step(work(0), 1.0)
    begin = time.process_time()
    for _ in range(frames):
        state = world.state()
        robot_state(state).model_dump_json()
    return 30.0 * (time.process_time() - begin) / frames


def main() -> None:
    """Print the table."""
    begin = time.perf_counter()
    world = World()
    loaded_s = time.perf_counter() - begin
    world.step(work(0), FRAME_S)
    factor, took = speed(world, 20.0)
    render = []
    for _ in range(20):
        begin = time.perf_counter()
        world.head_camera_rgb()
        render.append(time.perf_counter() - begin)
    share = telling(world, 300)
    table = Table("simulation, 240 Hz, greenhouse row loaded, one core", "measured", "wanted")
    p50, p95, p99 = (1e3 * np.percentile(took, (50, 95, 99))).tolist()
    rows = (
        ("times real time (processor time)", f"{factor:.1f}", ">= 4"),
        ("one frame's step (8 ticks), wall, p50 / p95 / p99", f"{p50:.2f} / {p95:.2f} / {p99:.2f} ms", "33.3 ms"),
        ("loading", f"{loaded_s * 1e3:.0f} ms", ""),
        ("head camera 320x240, p50", f"{1e3 * np.median(render):.1f} ms", ""),
        ("state read, packed, encoded for the console at 30 Hz", f"{100 * share:.2f} % of a core", "< 5 %"),
    )
    for row in rows:
        table.add_row(*row)
    Console().print(table)
    world.close()


if __name__ == "__main__":
    main()
