"""Where the robot stands when a run begins."""

from __future__ import annotations

from pydantic import Field

from robot_sim.section import RobotSection


class Start(RobotSection):
    """Without a fruit: at the origin, lift at home."""

    beside_fruit: str | None = Field(default=None, description="fruit that the gripper would reach [name]")
    off_m: float = Field(default=0.0, ge=-2.0, le=2.0, description="how far before that place the robot stands [m]")
    lift_off_m: float = Field(
        default=0.0,
        ge=-0.3,
        le=0.3,
        description="how far above its place the lift stands [m]; then no step of the upper arm alone is right",
    )
