"""Our types as Foxglove messages: a pure translation, no file and no clock."""

from __future__ import annotations

import math

import numpy as np
from foxglove.messages import (
    CameraCalibration,
    Color,
    CompressedImage,
    FrameTransform,
    FrameTransforms,
    JointState,
    JointStates,
    KeyValuePair,
    LinePrimitive,
    LinePrimitiveLineType,
    Point3,
    Pose,
    Quaternion,
    RawImage,
    SceneEntity,
    SceneEntityDeletion,
    SceneEntityDeletionType,
    SceneUpdate,
    SpherePrimitive,
    Timestamp,
    Vector3,
)
from scipy.spatial.transform import Rotation

from robot_sim.state import RobotState
from teleop.frames import Camera, ColorImage, DepthFrame, Intrinsics
from teleop.joints import BONES, JOINT_NAMES
from teleop.recording import topics
from teleop.skeleton import Skeleton

_UPRIGHT = Quaternion(x=0.0, y=0.0, z=0.0, w=1.0)
_JOINT_DIAMETER_M = 0.05


def timestamp(t_ns: int) -> Timestamp:
    """Nanoseconds as protobuf's seconds and nanoseconds."""
    return Timestamp(t_ns // 1_000_000_000, t_ns % 1_000_000_000)


def depth_image(frame: DepthFrame, t_ns: int) -> RawImage:
    """Depth as RawImage 16UC1: little endian, millimetres, rows without padding."""
    height, width = frame.depth_mm.shape
    return RawImage(
        timestamp=timestamp(t_ns),
        frame_id=topics.DEPTH_FRAME,
        width=width,
        height=height,
        encoding=topics.DEPTH_ENCODING,
        step=2 * width,
        data=np.ascontiguousarray(frame.depth_mm, dtype="<u2").tobytes(),
    )


def camera_info(t_ns: int, k: Intrinsics, frame_id: str) -> CameraCalibration:
    """A pinhole camera without distortion: K (3x3) and P (3x4), row by row."""
    return CameraCalibration(
        timestamp=timestamp(t_ns),
        frame_id=frame_id,
        width=k.width,
        height=k.height,
        distortion_model="plumb_bob",
        D=[0.0] * 5,
        K=[k.fx, 0.0, k.cx, 0.0, k.fy, k.cy, 0.0, 0.0, 1.0],
        R=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        P=[k.fx, 0.0, k.cx, 0.0, 0.0, k.fy, k.cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    )


def color_intrinsics(camera: Camera, image: ColorImage) -> Intrinsics:
    """The colour camera; registered colour has the depth camera's view at its own resolution."""
    height, width = image.shape[:2]
    return (camera.color or camera.depth).scaled(width, height)


def color_image(t_ns: int, jpeg: bytes) -> CompressedImage:
    """A JPEG."""
    return CompressedImage(timestamp=timestamp(t_ns), frame_id=topics.COLOR_FRAME, data=jpeg, format="jpeg")


def skeleton_scene(t_ns: int, skeleton: Skeleton | None, camera: Camera) -> SceneUpdate:
    """Known joints as spheres, bones as lines, in the depth camera's optical frame; None removes the person."""
    if skeleton is None:
        return SceneUpdate(
            deletions=[
                SceneEntityDeletion(timestamp=timestamp(t_ns), type=SceneEntityDeletionType.MatchingId, id="operator")
            ]
        )
    # Skeleton space to optical axes: teleop.frames, x_opt = x_sign x, y_opt = -y.
    optical = skeleton.joints_m * np.array([camera.x_sign, -1.0, 1.0])
    known = ~np.isnan(optical).any(axis=1)
    spheres = [
        SpherePrimitive(
            pose=Pose(position=Vector3(x=float(x), y=float(y), z=float(z)), orientation=_UPRIGHT),
            size=Vector3(x=_JOINT_DIAMETER_M, y=_JOINT_DIAMETER_M, z=_JOINT_DIAMETER_M),
            color=Color(r=1.0 - float(c), g=float(c), b=0.2, a=1.0),
        )
        for (x, y, z), c in zip(optical[known], np.clip(skeleton.confidence[known], 0.0, 1.0), strict=True)
    ]
    ends = [i for bone in BONES if known[bone[0]] and known[bone[1]] for i in bone]
    lines = LinePrimitive(
        type=LinePrimitiveLineType.LineList,
        pose=Pose(position=Vector3(x=0.0, y=0.0, z=0.0), orientation=_UPRIGHT),
        thickness=0.015,
        points=[Point3(x=float(p[0]), y=float(p[1]), z=float(p[2])) for p in optical[ends]],
        color=Color(r=0.9, g=0.9, b=0.9, a=1.0),
    )
    names = ",".join(name for name, is_known in zip(JOINT_NAMES, known, strict=True) if is_known)
    return SceneUpdate(
        entities=[
            SceneEntity(
                timestamp=timestamp(t_ns),
                frame_id=topics.DEPTH_FRAME,
                id="operator",
                metadata=[KeyValuePair(key="joints", value=names)],
                spheres=spheres,
                lines=[lines] if ends else [],
            )
        ]
    )


def joint_states(t_ns: int, state: RobotState) -> JointStates:
    """Joint positions under their URDF names, rad or m."""
    return JointStates(
        timestamp=timestamp(t_ns),
        joints=[JointState(name=name, position=float(q)) for name, q in state.joint_rad.items()],
    )


def color_pose(camera: Camera) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """T_depth_color: the colour camera's optical axes in the depth camera's; the same where colour is registered.

    Place (3,) [m] and quaternion x, y, z, w.
    """
    T = np.eye(4) if camera.T_color_depth is None else np.linalg.inv(np.array(camera.T_color_depth))
    turn = Rotation.from_matrix(T[:3, :3]).as_quat()
    return tuple(float(v) for v in T[:3, 3]), tuple(float(v) for v in turn)


def color_transform(t_ns: int, camera: Camera) -> FrameTransforms:
    """Where the colour camera is, see color_pose."""
    place, (x, y, z, w) = color_pose(camera)
    return FrameTransforms(
        transforms=[
            FrameTransform(
                timestamp=timestamp(t_ns),
                parent_frame_id=topics.DEPTH_FRAME,
                child_frame_id=topics.COLOR_FRAME,
                translation=Vector3(x=place[0], y=place[1], z=place[2]),
                rotation=Quaternion(x=x, y=y, z=z, w=w),
            )
        ]
    )


def base_transform(t_ns: int, state: RobotState, base_frame: str) -> FrameTransforms:
    """T_world_base: the chassis stands on the ground and turns about z."""
    half = 0.5 * state.base_yaw_rad
    return FrameTransforms(
        transforms=[
            FrameTransform(
                timestamp=timestamp(t_ns),
                parent_frame_id=topics.WORLD_FRAME,
                child_frame_id=base_frame,
                translation=Vector3(x=state.base_x_m, y=state.base_y_m, z=0.0),
                rotation=Quaternion(x=0.0, y=0.0, z=math.sin(half), w=math.cos(half)),
            )
        ]
    )
