"""From the frozen types of teleop and robot_sim to the wire's State. Pure."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from robot_sim.commands import ArmTarget, RobotCommand
from robot_sim.state import RobotState
from server import wire
from teleop.assist.aim import Aim
from teleop.assist.task import PickTask
from teleop.config.assist import AssistConfig
from teleop.frames import Camera, pixels
from teleop.intent_types import BodyAngles, Hands
from teleop.joints import JOINT_NAMES
from teleop.recording.recorded import RecordedPose
from teleop.skeleton import FloorPlane, Skeleton


def finite(value: float | None, digits: int = 4) -> float | None:
    """Rounded, or None where there is no finite number."""
    return round(float(value), digits) if value is not None and math.isfinite(value) else None


def skeleton_state(skeleton: Skeleton | None, camera: Camera) -> wire.SkeletonState | None:
    """Joints to millimetre, pixels to a tenth."""
    if skeleton is None:
        return None
    with np.errstate(divide="ignore", invalid="ignore"):
        uv = pixels(skeleton.joints_m, camera)
    joints: dict[str, tuple[float, float, float] | None] = {}
    places: dict[str, tuple[float, float] | None] = {}
    for name, (x, y, z), (u, v) in zip(JOINT_NAMES, skeleton.joints_m.tolist(), uv.tolist(), strict=True):
        known = math.isfinite(x + y + z)
        joints[name] = (round(x, 3), round(y, 3), round(z, 3)) if known else None
        places[name] = (round(u, 1), round(v, 1)) if known and math.isfinite(u + v) else None
    confidence = dict(zip(JOINT_NAMES, np.nan_to_num(skeleton.confidence).round(3).tolist(), strict=True))
    return wire.SkeletonState(joints=joints, pixels=places, confidence=confidence)


def floor_state(floor: FloorPlane | None) -> wire.FloorState | None:
    """Camera height, tilt as the angle between the floor's normal and the camera's y axis, and its two components."""
    if floor is None:
        return None
    up = floor.normal / np.linalg.norm(floor.normal)
    tilt_deg = math.degrees(math.acos(float(np.clip(up[1], -1.0, 1.0))))
    return wire.FloorState(
        camera_height_m=round(float(floor.camera_height_m), 3),
        tilt_deg=round(tilt_deg, 2),
        # the rotation that teleop.level makes of a tilt, read backwards
        pitch_deg=round(math.degrees(math.atan2(up[2], up[1])), 2),
        roll_deg=round(math.degrees(math.atan2(up[0], up[1])), 2),
    )


def angles_state(angles: BodyAngles) -> wire.AnglesState:
    """Degrees to a hundredth."""
    right, left = angles.right, angles.left
    return wire.AnglesState(
        theta1_right=finite(right.theta1_deg, 2),
        theta2_right=finite(right.theta2_deg, 2),
        theta3_right=finite(right.theta3_deg, 2),
        theta1_left=finite(left.theta1_deg, 2),
        theta2_left=finite(left.theta2_deg, 2),
        theta3_left=finite(left.theta3_deg, 2),
        T1=finite(angles.T1_deg, 2),
        T2=finite(angles.T2_deg, 2),
    )


def hands_state(hands: Hands) -> wire.HandsState:
    """Both hands."""
    return wire.HandsState(
        right=hands.right.value,
        left=hands.left.value,
        right_confidence=finite(hands.right_confidence, 3) or 0.0,
        left_confidence=finite(hands.left_confidence, 3) or 0.0,
    )


def command_state(command: RobotCommand) -> wire.CommandState:
    """The command as JSON."""
    return wire.CommandState(
        drive_m_s=round(command.drive_m_s, 4),
        turn_rad_s=round(command.turn_rad_s, 4),
        right_arm=_arm(command.right_arm),
        left_arm=_arm(command.left_arm),
        rear_arm=_arm(command.rear_arm),
        lift_m=finite(command.lift_m),
        disc_rad=finite(command.disc_rad),
        gripper_open=command.gripper_open,
        cutter_closed=command.cutter_closed,
        spray_on=command.spray_on,
        liquid=command.liquid.value if command.liquid else None,
        head_camera_sweep=command.head_camera_sweep,
        reasons=command.reasons,
    )


def robot_state(state: RobotState) -> wire.RobotWire:
    """Poses to a tenth of a millimetre and of a milliradian."""
    return wire.RobotWire(
        base=wire.BasePose(x=round(state.base_x_m, 4), y=round(state.base_y_m, 4), yaw=round(state.base_yaw_rad, 4)),
        joints={name: round(float(value), 4) for name, value in state.joint_rad.items()},
        targets={name: round(float(value), 4) for name, value in state.target_rad.items()},
        gripper_open=state.gripper_open,
        cutter_closed=state.cutter_closed,
        spray_on=state.spray_on,
        liquid=state.liquid.value,
        estop=state.estop,
        drive_m_s=round(state.drive_m_s, 4),
        turn_rad_s=round(state.turn_rad_s, 4),
        sim_time_s=round(state.sim_time_s, 3),
        reasons=state.reasons,
        tank_l={name: round(float(litres), 3) for name, litres in state.tank_l.items()},
        fruits=dict(state.fruits),
        moved={name: _pose(pose) for name, pose in state.moved.items()},
    )


def ghost_state(pose: RecordedPose | None) -> wire.Ghost | None:
    """Where the robot was when the recording was made; rounded as the robot's own state."""
    if pose is None:
        return None
    base = wire.BasePose(x=round(pose.x_m, 4), y=round(pose.y_m, 4), yaw=round(pose.yaw_rad, 4))
    return wire.Ghost(base=base, joints={name: round(q, 4) for name, q in pose.joint_rad.items()})


def preview(task: PickTask | None) -> wire.TaskPreview:
    """Where a pick will go, to the millimetre; empty without a plan."""
    if task is None or task.plan is None:
        return wire.TaskPreview()
    to_fruit, to_box = (tuple(_millimetres(point) for point in line) for line in task.plan.shown_m)
    return wire.TaskPreview(
        task=task.id, fruit=task.fruit, drive_m=round(task.plan.drive_m, 3), to_fruit=to_fruit, to_box=to_box
    )


def aim_state(aim: Aim, config: AssistConfig) -> wire.AimState | None:
    """What the operator points at, while they do."""
    if not aim.armed or aim.raised_s < config.aim_begin_s:
        return None
    return wire.AimState(fruit=aim.fruit, progress=round(aim.progress(config), 2))


def _millimetres(point: Iterable[float]) -> tuple[float, float, float]:
    x, y, z = (round(float(value), 3) for value in point)
    return x, y, z


def merged_reasons(*groups: Iterable[str]) -> tuple[str, ...]:
    """Every code once, in order of first appearance."""
    return tuple(dict.fromkeys(str(code) for group in groups for code in group))


def _pose(pose: tuple[float, ...]) -> tuple[float, float, float, float, float, float, float]:
    x, y, z, qx, qy, qz, qw = (round(float(value), 4) for value in pose)
    return x, y, z, qx, qy, qz, qw


def _arm(target: ArmTarget | None) -> wire.ArmTargetState | None:
    if target is None:
        return None
    return wire.ArmTargetState(
        c1_deg=round(target.c1_deg, 2), c2_deg=round(target.c2_deg, 2), elbow_deg=round(target.elbow_deg, 2)
    )
