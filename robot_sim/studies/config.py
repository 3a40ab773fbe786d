"""Numbers of the studies: what the sources state, and the choices made where they are silent."""

from __future__ import annotations

from pydantic import Field

from robot_sim.config import RobotSection


class TomatoStudyConfig(RobotSection):
    """Workspace grid and trajectory of the cherry-tomato arm."""

    step1_deg: float = Field(default=80.0, gt=0, le=180, description="step of joint 1 [deg]; source, step (2)")
    step_deg: float = Field(default=50.0, gt=0, le=180, description="step of the other joints [deg]; source, step (2)")
    fine_step_deg: float = Field(default=5.0, ge=1, le=45, description="step of the fine grid [deg]; choice")
    voxel_m: float = Field(default=0.03, ge=0.005, le=0.5, description="voxel edge of the fine void check [m]; choice")
    start_deg: tuple[float, float, float, float, float] = Field(
        default=(0.0, 0.0, 0.0, 0.0, 0.0), description="q1 [deg]; source, 3.2"
    )
    end_deg: tuple[float, float, float, float, float] = Field(
        default=(-45.0, 180.0, 135.0, -90.0, 90.0), description="q2 [deg]; source, 3.2"
    )
    duration_s: float = Field(default=2.0, gt=0, le=60, description="time from q1 to q2 [s]; source, 3.2")
    sample_s: float = Field(default=0.02, gt=0, le=1, description="interpolation step [s]; source, 3.2")
