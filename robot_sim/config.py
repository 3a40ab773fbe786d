"""The robot's configuration: dimensions, masses, limits, speeds; frozen, validated, every number with its unit."""

from __future__ import annotations

from math import pi
from typing import Literal, Self

from pydantic import Field, model_validator

from robot_sim.pick_config import PickConfig
from robot_sim.section import RobotSection
from robot_sim.start_config import Start


class AxisLimits(RobotSection):
    """Range, speed, acceleration and effort of one driven joint (radians, or metres for the lift)."""

    lower: float = Field(ge=-10.0, le=10.0, description="lowest position [rad or m]; source: choice")
    upper: float = Field(ge=-10.0, le=10.0, description="highest position [rad or m]; source: choice")
    speed: float = Field(gt=0.0, le=20.0, description="highest speed [rad/s or m/s]; source: choice")
    acceleration: float = Field(gt=0.0, le=200.0, description="highest acceleration [rad/s2 or m/s2]; source: choice")
    effort: float = Field(gt=0.0, le=5000.0, description="highest motor torque or force [Nm or N]; source: choice")

    @model_validator(mode="after")
    def _range_is_not_empty(self) -> Self:
        if self.lower >= self.upper:
            raise ValueError(f"lower ({self.lower}) must be below upper ({self.upper})")
        return self


class ChassisConfig(RobotSection):
    """Crawler chassis: x forward, y left; two tracks with one brushless motor each."""

    length_m: float = Field(default=0.92, ge=0.4, le=2.0, description="length over the tracks [m]; fits a 1.4 m aisle")
    width_m: float = Field(default=0.62, ge=0.3, le=1.2, description="width over the tracks [m]")
    track_width_m: float = Field(default=0.11, ge=0.05, le=0.3, description="width of one track [m]")
    wheel_radius_m: float = Field(
        default=0.085, ge=0.04, le=0.2, description="radius of the road wheels, track included [m]"
    )
    deck_height_m: float = Field(default=0.30, ge=0.15, le=0.6, description="top of the deck over the floor [m]")
    mass_kg: float = Field(default=62.0, ge=10.0, le=300.0, description="frame, motors, battery, tanks (full) [kg]")
    wheel_mass_kg: float = Field(
        default=1.6, ge=0.1, le=10.0, description="one road wheel with its part of the track [kg]"
    )
    track_friction: float = Field(default=0.9, ge=0.1, le=2.0, description="rubber on concrete, along the tracks [1]")
    scrub_friction: float = Field(
        default=0.05,
        ge=0.0,
        le=1.0,
        description="outer road wheels across the tracks, which a turn drags sideways [1]; choice: a crowned "
        "band presses least at its ends",
    )
    drive_m_s: float = Field(default=0.5, ge=0.05, le=2.0, description="highest speed [m/s]; walking pace between rows")
    turn_rad_s: float = Field(default=0.8, ge=0.05, le=3.0, description="highest turning rate on the spot [rad/s]")
    drive_m_s2: float = Field(default=0.8, ge=0.05, le=5.0, description="acceleration of driving [m/s2]")
    turn_rad_s2: float = Field(default=1.6, ge=0.05, le=10.0, description="acceleration of turning [rad/s2]")
    stop_m_s2: float = Field(default=2.0, ge=0.2, le=10.0, description="braking when told to stand still [m/s2]")
    stop_rad_s2: float = Field(
        default=4.0, ge=0.2, le=20.0, description="braking of turning when told to stand still [rad/s2]"
    )
    estop_m_s2: float = Field(
        default=8.0,
        ge=0.2,
        le=10.0,
        description="braking on emergency stop [m/s2]; the tracks grip up to 8.8; from full speed with the lift up and "
        "arms ahead wheels lift by less than 2 mm",
    )
    estop_rad_s2: float = Field(
        default=20.0, ge=0.2, le=20.0, description="braking of turning on emergency stop [rad/s2]"
    )
    motor_nm: float = Field(
        default=40.0, ge=1.0, le=500.0, description="torque of one track's motor at its wheels [Nm]"
    )
    brake_nm: float = Field(
        default=100.0,
        ge=1.0,
        le=500.0,
        description="torque of one track's spring-applied brake, with its motor, at its wheels [Nm]; choice: more than "
        "the track grips; it closes on emergency stop",
    )
    heading_gain_1_s: float = Field(
        default=4.0, ge=0.0, le=20.0, description="gyro: turning rate per heading error [1/s]"
    )

    @model_validator(mode="after")
    def _brake_holds_the_motor(self) -> Self:
        if self.brake_nm < self.motor_nm:
            raise ValueError(f"brake_nm ({self.brake_nm}) must be at least motor_nm ({self.motor_nm})")
        return self


class ArmConfig(RobotSection):
    """One of three identical arms: 2-DOF shoulder (C1, C2) and elbow."""

    upper_m: float = Field(
        default=0.29, ge=0.1, le=0.8, description="shoulder to elbow [m]; about a person's upper arm"
    )
    forearm_m: float = Field(
        default=0.25, ge=0.1, le=0.8, description="elbow to tool flange [m]; about a person's forearm"
    )
    shoulder_offset_m: float = Field(
        default=0.20, ge=0.1, le=0.6, description="right, left shoulder beside the mast [m]"
    )
    forward_offset_m: float = Field(
        default=0.08, ge=-0.2, le=0.4, description="right, left shoulder before the mast [m]"
    )
    toe_in_rad: float = Field(
        default=0.279,
        ge=0.0,
        le=0.8,
        description="right and left shoulder frames turned inwards [rad]; choice: C2 only swings outwards (0..90 deg "
        "in the source), so the planes of the two hanging arms must meet where the crop is for the box to come "
        "under the gripper",
    )
    rear_offset_m: float = Field(default=0.24, ge=0.1, le=0.6, description="rear shoulder behind the mast [m]")
    upper_kg: float = Field(default=1.1, ge=0.1, le=10.0, description="mass of the upper arm with the elbow servo [kg]")
    forearm_kg: float = Field(default=0.7, ge=0.1, le=10.0, description="mass of the forearm [kg]")
    tool_kg: float = Field(default=0.35, ge=0.02, le=5.0, description="mass of an end effector [kg]")
    c1: AxisLimits = Field(
        default_factory=lambda: AxisLimits(lower=-0.35, upper=2.1, speed=2.6, acceleration=16.0, effort=45.0),
        description="shoulder axis C1, forward positive [rad]",
    )
    c2: AxisLimits = Field(
        default_factory=lambda: AxisLimits(lower=-0.45, upper=1.75, speed=2.6, acceleration=16.0, effort=45.0),
        description="shoulder axis C2, outward positive [rad]; inward so far that the hands meet before the chest",
    )
    elbow: AxisLimits = Field(
        default_factory=lambda: AxisLimits(lower=0.0, upper=2.2, speed=3.2, acceleration=20.0, effort=25.0),
        description="elbow, 0 straight, bending forward positive [rad]",
    )


class UpperBodyConfig(RobotSection):
    """Lift, disc and head: what carries the arms."""

    chest_yaw_rad: float = Field(
        default=pi / 2,
        ge=-pi,
        le=pi,
        description="where the chest faces at disc zero, from forward to the left [rad]; choice: the crop stands "
        "beside the aisle, so that driving moves the arms along the row",
    )
    shoulder_height_m: float = Field(
        default=1.30, ge=0.8, le=2.0, description="shoulders over the floor, lift down [m]"
    )
    home_lift_m: float = Field(default=0.10, ge=0.0, le=1.0, description="lift at the start [m]")
    lift: AxisLimits = Field(
        default_factory=lambda: AxisLimits(lower=0.0, upper=0.40, speed=0.12, acceleration=0.5, effort=2500.0),
        description="self-locking lift (lead screw) [m]",
    )
    disc: AxisLimits = Field(
        # a half turn in pi/speed + speed/acceleration = 2.0 s
        default_factory=lambda: AxisLimits(lower=-3.2, upper=3.2, speed=2.1, acceleration=4.2, effort=220.0),
        description="rotating disc that carries the upper body [rad]",
    )
    head_pan: AxisLimits = Field(
        default_factory=lambda: AxisLimits(lower=-1.2, upper=1.2, speed=0.6, acceleration=3.0, effort=4.0),
        description="turning base of the head camera [rad]",
    )
    head_tilt_rad: float = Field(
        default=0.42, ge=-1.0, le=1.2, description="fixed downward tilt of the head camera [rad]"
    )
    head_fov_rad: float = Field(
        default=1.12, ge=0.3, le=2.5, description="vertical field of view of the head camera [rad]"
    )
    upper_body_kg: float = Field(default=14.0, ge=2.0, le=80.0, description="torso with shoulders [kg]")


class ToolConfig(RobotSection):
    """Gripper and cutter on the right arm, box on the left, sprayer on the rear."""

    gripper: Literal["long", "soft"] = Field(
        default="long", description="long: flat pads for cucumbers; soft: cupped, hand-like, for tomatoes and grapes"
    )
    jaw: AxisLimits = Field(
        default_factory=lambda: AxisLimits(lower=0.0, upper=0.060, speed=0.30, acceleration=3.0, effort=14.0),
        description="travel of one gripper jaw from closed [m]; a cucumber is about 4 cm thick",
    )
    cutter: AxisLimits = Field(
        default_factory=lambda: AxisLimits(lower=0.0, upper=0.75, speed=5.0, acceleration=60.0, effort=6.0),
        description="cutter blade, 0 open, upper closed [rad]",
    )
    box_kg: float = Field(
        default=0.55, ge=0.05, le=5.0, description="fruit box, 3 mm polypropylene sheet (0.19 m2 at 905 kg/m3) [kg]"
    )
    bruise_n: float = Field(
        default=80.0, ge=1.0, le=1000.0, description="contact force that damages a cucumber [N]; choice: a firm squeeze"
    )
    peduncle_n: float = Field(default=40.0, ge=1.0, le=500.0, description="pull at which a peduncle tears [N]")


class SprayConfig(RobotSection):
    """Three-channel sprayer: one liquid at a time through its nozzle."""

    tank_l: float = Field(default=4.0, gt=0.0, le=50.0, description="content of one full tank [l]")
    flow_l_s: float = Field(
        default=0.04,
        gt=0.0,
        le=1.0,
        description="flow of one nozzle [l/s]; source: ISO 10625 size 06, 2.4 l/min at 3 bar",
    )
    cone_rad: float = Field(
        default=1.05,
        ge=0.02,
        le=1.3,
        description="half the opening angle of the cone [rad]; source: wide-angle full-cone nozzles, 120 deg of the "
        "15..125 deg makers offer; the nozzle passes 0.3 m before the leaves",
    )
    range_m: float = Field(default=1.2, ge=0.1, le=5.0, description="how far droplets carry [m]")
    droplet_um: float = Field(
        default=180.0,
        ge=20.0,
        le=1000.0,
        description="volume median diameter of a droplet [um]; source: ISO 25358 class fine, 150..250 um",
    )
    spread_factor: float = Field(
        default=2.5,
        ge=1.0,
        le=6.0,
        description="diameter of a droplet's spot on the leaf over its own [1]; choice: about 2 for water on a "
        "wettable leaf, more with a wetting agent",
    )
    parcels_1_s: float = Field(default=1200.0, ge=10.0, le=20000.0, description="parcels of droplets simulated [1/s]")

    @property
    def parcel_m2(self) -> float:
        """Leaf area that one parcel of droplets wets [m2].

        A litre of droplets of diameter d that spread to s d covers (pi/4 s^2 d^2) / (pi/6 d^3) = 1.5 s^2 / d.
        """
        litre_m2 = 1e-3 * 1.5 * self.spread_factor**2 / (1e-6 * self.droplet_um)
        return litre_m2 * self.flow_l_s / self.parcels_1_s


CropName = Literal["cucumber", "tomato", "grape"]


class GreenhouseConfig(RobotSection):
    """Two crop rows along x with an aisle between them; the robot starts in the aisle at the origin."""

    row_start_m: float = Field(default=-1.1, ge=-20.0, le=0.0, description="where the rows begin [m]")
    left_crop: CropName = Field(default="cucumber", description="what grows in the left row (+y)")
    right_crop: CropName = Field(default="tomato", description="what grows in the right row (-y)")
    ripe_share: float = Field(default=0.8, ge=0.0, le=1.0, description="share of the fruit that is ripe [1]")
    diseased_share: float = Field(
        default=0.15, ge=0.0, le=1.0, description="share of the plants with mildew, which want pesticide [1]"
    )
    row_end_m: float = Field(default=2.9, ge=0.5, le=40.0, description="where the rows end [m]")
    row_offset_m: float = Field(default=0.86, ge=0.7, le=2.0, description="from the aisle's middle to a row's [m]")
    gutter_height_m: float = Field(default=0.50, ge=0.2, le=1.0, description="bottom of the hanging gutters [m]")
    gutter_width_m: float = Field(default=0.20, ge=0.1, le=0.5, description="width of a gutter [m]")
    plant_spacing_m: float = Field(
        default=0.48, ge=0.25, le=1.5, description="between plants in a row [m]; common: 0.4 to 0.5"
    )
    plant_height_m: float = Field(default=1.45, ge=0.5, le=3.0, description="from the gutter to the training wire [m]")
    leaves_per_plant: int = Field(default=9, ge=0, le=40, description="leaves of one plant")
    fruits_per_plant: int = Field(default=2, ge=0, le=8, description="cucumbers, or trusses of tomatoes, of one plant")
    fruit_offset_m: float = Field(
        default=0.57, ge=0.4, le=1.5, description="from the aisle's middle to hanging fruit [m]; in reach"
    )
    fruit_low_m: float = Field(default=1.00, ge=0.4, le=2.0, description="lowest middle of a fruit over the floor [m]")
    fruit_high_m: float = Field(
        default=1.45, ge=0.5, le=2.4, description="highest middle of a fruit over the floor [m]"
    )


class ClearanceConfig(RobotSection):
    """How near arms, tools and trunk may come; collision shapes as capsules."""

    arm_gap_m: float = Field(
        default=0.015, ge=0.0, le=0.3, description="between two arms with their tools [m]; choice: servo error at speed"
    )
    reserve_m: float = Field(
        default=0.004, ge=0.0, le=0.1, description="braking begins this much earlier [m]; two arms go on for a tick"
    )
    body_gap_m: float = Field(
        default=0.005, ge=0.0, le=0.3, description="between forearm or tool and the trunk [m]; choice: servo error"
    )
    reach_m: float = Field(
        default=1.05, ge=0.3, le=3.0, description="tools stay this near the disc's axis [m]; choice: row plus 0.2 m"
    )
    low_m: float = Field(
        default=-0.55,
        ge=-3.0,
        le=0.5,
        description="lowest point of a tool over the disc [m]; choice: clear of the deck",
    )
    high_m: float = Field(
        default=1.15, ge=0.1, le=3.0, description="highest point of a tool over the disc [m]; choice: below the lamps"
    )


class SerialConfig(RobotSection):
    """The link to a servo controller (docs/servo_protocol.md)."""

    baud: int = Field(default=115200, ge=9600, le=4_000_000, description="speed of the serial port [baud]")
    ack_timeout_s: float = Field(
        default=0.03, ge=0.005, le=1.0, description="wait for an answer before sending again [s]; a line takes 10 ms"
    )
    retries: int = Field(default=2, ge=0, le=10, description="how often a line is sent again [1]")
    lost_after_s: float = Field(
        default=0.5, ge=0.05, le=10.0, description="silence after which the emergency stop is latched [s]"
    )


class ServoConfig(RobotSection):
    """How coarse real servos are; off by default, so that the simulation is exact."""

    whole_degrees: bool = Field(
        default=False, description="arm set-points are rounded to whole degrees; source: its servo controller"
    )
    backlash_rad: float = Field(
        default=0.0, ge=0.0, le=0.1, description="play of the arms' gears [rad]; hobby servos have about 0.01"
    )


class RobotConfig(RobotSection):
    """Everything about the robot that can be changed without changing code."""

    chassis: ChassisConfig = Field(default_factory=ChassisConfig)
    arm: ArmConfig = Field(default_factory=ArmConfig)
    body: UpperBodyConfig = Field(default_factory=UpperBodyConfig)
    tool: ToolConfig = Field(default_factory=ToolConfig)
    spray: SprayConfig = Field(default_factory=SprayConfig)
    greenhouse: GreenhouseConfig = Field(default_factory=GreenhouseConfig)
    clearance: ClearanceConfig = Field(default_factory=ClearanceConfig)
    serial: SerialConfig = Field(default_factory=SerialConfig)
    servo: ServoConfig = Field(default_factory=ServoConfig)
    pick: PickConfig = Field(default_factory=PickConfig)
    start: Start = Field(default_factory=Start)
    position_gain: float = Field(
        default=0.35, ge=0.01, le=1.0, description="servo loop: share of the error removed per tick"
    )
    disc_still_rad: float = Field(
        default=0.01, ge=1e-4, le=0.2, description="the disc counts as turning above this [rad]"
    )
