"""Numbers of the studies: what the sources state, and the choices made where they are silent."""

from __future__ import annotations

from pydantic import Field

from robot_sim.section import RobotSection


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


class BottleConfig(RobotSection):
    """A culture bottle: straight neck over a wider body; the source prints no sizes."""

    neck_radius_m: float = Field(default=0.0275, ge=0.01, le=0.2, description="inner radius of the neck [m]; choice")
    neck_height_m: float = Field(default=0.020, ge=0.0, le=0.2, description="height of the neck [m]; choice")
    body_radius_m: float = Field(default=0.038, ge=0.01, le=0.3, description="inner radius of the body [m]; choice")
    glass_m: float = Field(default=0.003, ge=0.0005, le=0.02, description="thickness of the glass [m]; choice")
    height_m: float = Field(default=0.110, ge=0.03, le=0.5, description="mouth to inner bottom [m]; choice")


class PlantletStudyConfig(RobotSection):
    """Way points, times and the servo error model of the transplanting arm."""

    bottle: BottleConfig = Field(default_factory=lambda: BottleConfig())
    above_mouth_m: float = Field(default=0.020, ge=0.0, le=0.1, description="P1, P4 above the mouth [m]; source 1")
    depth_m: float = Field(default=0.080, ge=0.01, le=0.3, description="P1 to P2 and P4 to P5 [m]; source 1")
    wrist_p1_m: tuple[float, float, float] = Field(default=(0.25, 0.0, 0.15), description="wrist at P1 [m]; source 3.2")
    wrist_p3_m: tuple[float, float, float] = Field(default=(0.19, -0.16, 0.16), description="wrist at P3 [m]; choice")
    wrist_p4_m: tuple[float, float, float] = Field(default=(0.14, 0.20, 0.15), description="wrist at P4 [m]; choice")
    start_deg: tuple[float, float, float, float, float] = Field(
        default=(-60.0, -100.0, 80.0, 20.0, 0.0), description="P0, joint angles [deg]; choice"
    )
    turn_deg: float = Field(
        default=30.0, ge=-180, le=180, description="gripper turn theta before entering [deg]; source"
    )
    plantlet_m: float = Field(default=0.014, ge=0.0, le=0.1, description="P2 to the plantlet A, horizontal [m]; choice")
    carry_s: float = Field(default=3.0, gt=0, le=60, description="time of each carrying move [s]; source 3.1")
    line_s: float = Field(default=4.0, gt=0, le=60, description="time from P1 to P2 [s]; source 3.2")
    reach_s: float = Field(default=1.0, gt=0, le=60, description="time from P2 to A [s]; choice")
    step_s: float = Field(default=0.025, gt=0, le=1, description="way point interval [s]; source 3.1")
    pause_s: float = Field(default=0.5, ge=0, le=10, description="rest at P1 and P4 [s]; choice")
    tolerance_m: float = Field(
        default=0.0005, gt=0, le=0.01, description="accurate within this in x, y, z [m]; source 3.1"
    )
    source_share: float = Field(default=0.90, gt=0, lt=1, description="end points within it [1]; source 3.1")
    encoder_counts: int = Field(default=16384, ge=256, le=2**24, description="counts a turn at the joint [1]; choice")
    backlash_deg: float = Field(default=0.03, ge=0, le=2, description="lost motion of each joint [deg]; choice")
    offset_deg: float = Field(default=0.015, ge=0, le=2, description="joint zero error, sigma [deg]; choice")
    length_m: float = Field(default=0.00008, ge=0, le=0.01, description="link length error, sigma [m]; choice")
    random_ratio: float = Field(
        default=0.30,
        ge=0.05,
        le=0.95,
        description="share of the random part in the plain error's variance [1]; choice: small arms repeat about twice "
        "as well as they are accurate",
    )
    gauge_m: float = Field(
        default=0.00005, ge=0, le=0.005, description="measuring noise of calibration, sigma [m]; choice"
    )
    calibration_poses: int = Field(
        default=120, ge=10, le=1000, description="measured poses for calibration [1]; choice"
    )
    repeats: int = Field(
        default=20, ge=2, le=1000, description="repeats of the source's end-point test [1]; source 3.1"
    )


class GrapeStudyConfig(RobotSection):
    """Bunches, their surroundings, the camera's error, and how a pick is carried out. World axes: the arm's frame 0."""

    height_m: tuple[float, float] = Field(default=(0.162, 0.235), description="bunch height, range [m]; source 5.2")
    diameter_m: tuple[float, float] = Field(
        default=(0.108, 0.146), description="largest diameter, range [m]; source 5.2"
    )
    berry_m: tuple[float, float] = Field(default=(0.011, 0.014), description="berry radius, range [m]; choice (Kyoho)")
    peduncle_m: tuple[float, float] = Field(
        default=(0.060, 0.100), description="bare peduncle between bunch and cane, range [m]; choice"
    )
    stem_radius_m: float = Field(default=0.003, ge=0.001, le=0.01, description="radius of the peduncle [m]; choice")
    cane_radius_m: float = Field(default=0.008, ge=0.002, le=0.05, description="radius of the cane above [m]; choice")
    azimuth_deg: float = Field(
        default=45.0, ge=0, le=120, description="bunches hang within this of ahead [deg]; choice"
    )
    distance_m: tuple[float, float] = Field(default=(0.50, 0.64), description="bunch from the arm's axis [m]; choice")
    top_m: tuple[float, float] = Field(default=(-0.06, 0.14), description="bunch top over the shoulder [m]; choice")
    pair_gap: tuple[float, float] = Field(
        default=(0.80, 1.05), description="distance of an overlapping pair's axes over the sum of radii [1]; choice"
    )
    post_share: float = Field(default=0.5, ge=0, le=1, description="share of scenes with a trellis post [1]; choice")
    single_error_mm: tuple[float, float, float] = Field(
        default=(5.46, 6.56, 6.01),
        description="mean camera error x, depth, vertical [mm]; source table 2, vertical: mean",
    )
    pair_error_mm: tuple[float, float, float] = Field(
        default=(6.34, 7.87, 7.11), description="the same for overlapping bunches [mm]; source table 2, vertical: mean"
    )
    looks: int = Field(
        default=4, ge=1, le=100, description="independent camera looks averaged at the ready pose; choice"
    )
    margin_h1_m: float = Field(default=0.010, ge=0, le=0.05, description="least safety margin H1 [m]; choice")
    back_off_m: float = Field(
        default=0.16, ge=0.05, le=0.5, description="ready pose before the picking point [m]; choice"
    )
    start_m: tuple[float, float, float] = Field(
        default=(0.125, 0.34, 0.05), description="gripping point at start, clear of where bunches hang [m]; choice"
    )
    start_yaw_deg: float = Field(default=70.0, ge=-180, le=180, description="tool's yaw at the start [deg]; choice")
    basket_m: tuple[float, float, float] = Field(default=(0.10, -0.48, 0.10), description="over the basket [m]; choice")
    spacing_m: float = Field(default=0.07, gt=0, le=0.5, description="key points at most this far apart [m]; choice")
    speed_m_s: float = Field(default=0.25, gt=0, le=2, description="tool speed between key points [m/s]; choice")
    check_m: float = Field(default=0.012, gt=0, le=0.1, description="collision checks along the way every [m]; choice")
    press_m: float = Field(
        default=0.004, ge=0, le=0.02, description="a carried bunch may press into its neighbour [m]; choice"
    )
    close_m: float = Field(default=0.010, gt=0, le=0.1, description="the source's deviation limit [m]; source 5.2")
