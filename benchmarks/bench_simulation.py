"""How fast the simulated robot runs with its greenhouse row, and how true it is: speed, drift, tracking, rendering."""

from __future__ import annotations

import math
import time

import numpy as np
from rich.console import Console
from rich.table import Table

from robot_sim.commands import ArmTarget, RobotCommand
from robot_sim.config import GreenhouseConfig, RobotConfig
from robot_sim.world import World

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


def straight(world: World) -> float:
    """Sideways drift [m] after 2 m."""
    start = state = world.reset()
    while state.base_x_m - start.base_x_m < 2.0:
        state = world.step(RobotCommand(t_ns=0, drive_m_s=0.5), FRAME_S)
    return abs(state.base_y_m - start.base_y_m)


def on_the_spot(world: World) -> float:
    """Distance [m] from the start after a full turn."""
    start = state = world.reset()
    turned = 0.0
    while turned < 2.0 * math.pi:
        before = state
        state = world.step(RobotCommand(t_ns=0, turn_rad_s=0.8), FRAME_S)
        turned += math.remainder(state.base_yaw_rad - before.base_yaw_rad, 2.0 * math.pi)
    for _ in range(30):
        state = world.step(RobotCommand(t_ns=0), FRAME_S)
    return math.hypot(state.base_x_m - start.base_x_m, state.base_y_m - start.base_y_m)


def tracking() -> tuple[float, float]:
    """Largest error [deg] of the arms against their set-points: moving, and at rest; no fruit in the way."""
    world = World(RobotConfig(greenhouse=GreenhouseConfig(fruits_per_plant=0)))
    moving = resting = 0.0
    rng = np.random.default_rng(0)
    for _ in range(12):
        arm = ArmTarget(rng.uniform(0, 90), rng.uniform(0, 90), rng.uniform(90, 180))
        for frame in range(60):
            state = world.step(RobotCommand(t_ns=0, right_arm=arm, left_arm=arm, rear_arm=arm), FRAME_S)
            error = max(
                abs(state.joint_rad[j] - q) for j, q in state.target_rad.items() if j[-3:] in ("_c1", "_c2", "bow")
            )
            moving = max(moving, error)
            if frame >= 57:
                resting = max(resting, error)
    world.close()
    return math.degrees(moving), math.degrees(resting)


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
    moving_deg, resting_deg = tracking()
    table = Table("simulation, 240 Hz, greenhouse row loaded, one core", "measured", "wanted")
    p50, p95, p99 = (1e3 * np.percentile(took, (50, 95, 99))).tolist()
    rows = (
        ("times real time (processor time)", f"{factor:.1f}", ">= 4"),
        ("one frame's step (8 ticks), wall, p50 / p95 / p99", f"{p50:.2f} / {p95:.2f} / {p99:.2f} ms", "33.3 ms"),
        ("loading", f"{loaded_s * 1e3:.0f} ms", ""),
        ("head camera 320x240, p50", f"{1e3 * np.median(render):.1f} ms", ""),
        ("sideways after 2 m", f"{1e3 * straight(world):.2f} mm", "< 20 mm"),
        ("off after 360 deg on the spot", f"{1e3 * on_the_spot(world):.2f} mm", "< 50 mm"),
        ("arm tracking error, moving", f"{moving_deg:.3f} deg", "< 3 deg"),
        ("arm tracking error, at rest", f"{resting_deg:.4f} deg", "< 0.8 deg"),
    )
    for row in rows:
        table.add_row(*row)
    Console().print(table)
    world.close()


if __name__ == "__main__":
    main()
