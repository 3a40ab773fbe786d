"""How true the simulated robot is: chassis drift, arm tracking, and what it answers to wrong commands."""

from __future__ import annotations

import math

import numpy as np
from rich.console import Console
from rich.table import Table

from robot_sim.commands import ArmTarget, Liquid, RobotCommand
from robot_sim.config import GreenhouseConfig, RobotConfig, SprayConfig
from robot_sim.errors import RobotError
from robot_sim.scenario import PICK_POSE, load_scenario, standing_place
from robot_sim.world import World

FRAME_S = 1.0 / 30.0


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


def play(world: World, seconds: float, **command: object) -> tuple[str, str]:
    """Reason codes and events of a stretch of time."""
    reasons: dict[str, None] = {}
    events: dict[str, None] = {}
    for _ in range(round(seconds / FRAME_S)):
        state = world.step(RobotCommand(t_ns=0, **command), FRAME_S)  # type: ignore[arg-type]
        reasons |= dict.fromkeys(r for r in state.reasons if not r.startswith(("limit.joint_speed", "limit.chassis_a")))
        events |= dict.fromkeys(str(event.kind) for event in world.events)
    return ", ".join(reasons), ", ".join(events)


def refusals() -> list[tuple[str, str, str]]:
    """What was asked, the reason codes and the events."""
    world = World(RobotConfig(spray=SprayConfig(tank_l=0.05)))
    rows = [
        (
            "arm to 400 deg, 99 m/s, turn by NaN",
            *play(world, 1.0, right_arm=ArmTarget(400, 0, 180), drive_m_s=99.0, turn_rad_s=math.nan),
        )
    ]
    world.reset()
    rows.append(("spray with a tank of 0.05 l for 3 s", *play(world, 3.0, spray_on=True, liquid=Liquid.NUTRIENT)))
    world.reset()
    rows.append(("cut air", *play(world, 0.6, cutter_closed=True)))
    fruit = next(f for f in world.fruits if f.crop == "cucumber" and 0.2 < f.xyz_m[0] < 0.8)
    x_m, lift_m = standing_place(fruit, world.config)
    for _ in range(150):
        ahead = x_m - world.state().base_x_m
        play(world, FRAME_S, drive_m_s=min(0.3, max(-0.3, 2.0 * ahead)), lift_m=lift_m)
    play(world, 1.0, right_arm=PICK_POSE, cutter_closed=False)
    rows.append(("cut a fruit with the gripper open", *play(world, 2.0, cutter_closed=True)))
    world.reset()
    play(world, 2.2, turn_rad_s=0.8)
    reasons, events = play(world, 3.0, drive_m_s=0.5)
    gap_m = world.config.greenhouse.row_offset_m - world.state().base_y_m
    rows.append((f"drive into a gutter for 3 s: stands {gap_m:.2f} m before its middle", reasons, events))
    world.close()
    try:
        load_scenario("magnet")
    except RobotError as error:
        rows.append(("an unknown scenario", str(error), ""))
    return rows


def main() -> None:
    """Print the tables."""
    world = World()
    straight_m, spot_m = straight(world), on_the_spot(world)
    world.close()
    moving_deg, resting_deg = tracking()
    table = Table("drive and arms", "measured", "wanted")
    for row in (
        ("sideways after 2 m", f"{1e3 * straight_m:.2f} mm", "< 20 mm"),
        ("off after 360 deg on the spot", f"{1e3 * spot_m:.2f} mm", "< 50 mm"),
        ("arm tracking error, moving", f"{moving_deg:.3f} deg", "< 3 deg"),
        ("arm tracking error, at rest", f"{resting_deg:.4f} deg", "< 0.8 deg"),
    ):
        table.add_row(*row)
    answers = Table("asked", "reason codes", "events")
    for answer in refusals():
        answers.add_row(*answer)
    console = Console()
    console.print(table)
    console.print(answers)


if __name__ == "__main__":
    main()
