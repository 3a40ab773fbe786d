"""The first message of the stream: everything that stays the same while a source and a configuration last."""

from __future__ import annotations

from itertools import accumulate

from robot_sim.arm_angles import arm_joint_names
from robot_sim.commands import ARM_NAMES
from robot_sim.greenhouse import Primitive
from robot_sim.plants import Fruit
from server import wire
from server.settings import Settings
from teleop.frames import Camera
from teleop.joints import BONES, JOINT_NAMES
from teleop.software import software_version

URDF_URL = "/api/v1/robot/urdf"


def hello(settings: Settings, camera: Camera, scenery: tuple[Primitive, ...], fruits: tuple[Fruit, ...]) -> wire.Hello:
    """Zones as the threshold matrix gives them (source eq. 5), the robot's joints and ranges, the greenhouse."""
    intent, body = settings.teleop.effective_intent(), settings.robot.body
    zones, k = intent.zones, camera.depth
    return wire.Hello(
        software=software_version(),
        joint_names=JOINT_NAMES,
        bones=BONES,
        camera=wire.CameraInfo(
            width=k.width, height=k.height, fx=k.fx, fy=k.fy, cx=k.cx, cy=k.cy, mirrored=camera.mirrored
        ),
        zones=wire.ZoneInfo(
            depth_cuts_m=_cuts(zones.l1_m, zones.l2_m, zones.l3_m, zones.l4_m),
            center_half_width_m=zones.l6_m / 2,
            side_limit_m=zones.l6_m / 2 + zones.l5_m,
            hysteresis_m=zones.margin_m,
        ),
        shoulder_step_deg=intent.mapping.step_deg,
        T1_threshold_deg=intent.task.T1_deg,
        T2_threshold_deg=intent.task.T2_deg,
        urdf_url=URDF_URL,
        arm_joints={
            arm: wire.ArmJoints(**dict(zip(("c1", "c2", "elbow"), arm_joint_names(arm), strict=True)))
            for arm in ARM_NAMES
        },
        lift_range_m=(body.lift.lower, body.lift.upper),
        disc_range_rad=(body.disc.lower, body.disc.upper),
        full_tank_l=settings.robot.spray.tank_l,
        scenery=tuple(
            wire.SceneryItem(name=p.name, kind=p.kind, size_m=p.size_m, xyz_m=p.xyz_m, rpy_rad=p.rpy_rad, rgba=p.rgba)
            for p in scenery
        ),
        fruits=tuple(fruit_info(fruit) for fruit in fruits),
    )


def fruit_info(fruit: Fruit) -> wire.FruitInfo:
    """A fruit as it grew."""
    return wire.FruitInfo(
        name=fruit.name, crop=fruit.crop, ripe=fruit.ripe, xyz_m=fruit.xyz_m, radius_m=round(fruit.top_m, 4)
    )


def _cuts(*lengths_m: float) -> tuple[float, float, float, float]:
    a, b, c, d = (round(cut, 4) for cut in accumulate(lengths_m))
    return a, b, c, d
