"""The topics of a recording as Foxglove channels: one way to log them, to a file or to who looks on live."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from foxglove import Channel, Context, Schema
from foxglove.channels import (
    CameraCalibrationChannel,
    CompressedImageChannel,
    FrameTransformsChannel,
    JointStatesChannel,
    RawImageChannel,
    SceneUpdateChannel,
)

from robot_sim.state import RobotState
from teleop.errors import FrameError, RecordingError
from teleop.frames import Camera, DepthFrame
from teleop.intent_types import Event
from teleop.recording import messages, topics
from teleop.skeleton import Skeleton
from teleop.sources.jpeg import encode_jpeg


class Channels:
    """All topics in one context. Times are given by the caller; nothing is checked but what a message needs."""

    def __init__(self, context: Context, urdf: str | None, base_frame: str, jpeg_quality: int) -> None:
        """urdf: text for /robot_description. base_frame: its root link."""
        self._urdf = urdf
        self._jpeg_quality = jpeg_quality
        self._base_frame = base_frame
        self.depth = RawImageChannel(topics.DEPTH, context=context)
        self._depth_info = CameraCalibrationChannel(topics.DEPTH_INFO, context=context)
        self.color = CompressedImageChannel(topics.COLOR, context=context)
        self._color_info = CameraCalibrationChannel(topics.COLOR_INFO, context=context)
        self._joint_states = JointStatesChannel(topics.JOINT_STATES, context=context)
        self._tf = FrameTransformsChannel(topics.TF, context=context)
        self._tf_static = FrameTransformsChannel(topics.TF_STATIC, context=context)
        self._skeleton = SceneUpdateChannel(topics.SKELETON, context=context)
        self._description = _json_channel(topics.ROBOT_DESCRIPTION, "std_msgs/String", context)
        self._track = _json_channel(topics.TRACK, "teleop.Track", context)
        self._events = _json_channel(topics.EVENTS, "teleop.Event", context)
        self._inputs = _json_channel(topics.INPUTS, "teleop.Input", context)

    def log_depth(self, t_ns: int, frame: DepthFrame) -> None:
        """Depth of one frame."""
        self.depth.log(messages.depth_image(frame, t_ns), log_time=t_ns)

    def log_color(self, t_ns: int, frame: DepthFrame) -> None:
        """Colour of one frame, if it has any. Raises RecordingError."""
        if frame.color_rgb is None:
            return
        try:
            jpeg = frame.color_jpeg or encode_jpeg(frame.color_rgb, self._jpeg_quality)
        except FrameError as error:
            raise RecordingError(str(error)) from None
        self.color.log(messages.color_image(t_ns, jpeg), log_time=t_ns)

    def log_depth_info(self, t_ns: int, camera: Camera) -> None:
        """The depth camera."""
        self._depth_info.log(messages.camera_info(t_ns, camera.depth, topics.DEPTH_FRAME), log_time=t_ns)

    def log_color_info(self, t_ns: int, frame: DepthFrame) -> None:
        """The colour camera of a frame, if it has colour, and where it is."""
        if frame.color_rgb is not None:
            self._tf_static.log(messages.color_transform(t_ns, frame.camera), log_time=t_ns)
            k = messages.color_intrinsics(frame.camera, frame.color_rgb)
            self._color_info.log(messages.camera_info(t_ns, k, topics.COLOR_FRAME), log_time=t_ns)

    def log_description(self, t_ns: int) -> None:
        """The URDF, if there is one."""
        if self._urdf:
            self._description.log(json.dumps({"data": self._urdf}), log_time=t_ns)

    def log_skeleton(self, t_ns: int, skeleton: Skeleton | None, camera: Camera) -> None:
        """The skeleton as a 3-D scene; None takes the last one away."""
        self._skeleton.log(messages.skeleton_scene(t_ns, skeleton, camera), log_time=t_ns)

    def log_robot(self, t_ns: int, state: RobotState) -> None:
        """Joint positions and the pose of the chassis."""
        self._joint_states.log(messages.joint_states(t_ns, state), log_time=t_ns)
        self._tf.log(messages.base_transform(t_ns, state, self._base_frame), log_time=t_ns)

    def log_row(self, t_ns: int, row: Mapping[str, Any]) -> None:
        """One row of ``teleop track``. Raises RecordingError when it is no plain JSON."""
        self._json(self._track, t_ns, row)

    def log_event(self, t_ns: int, event: Event) -> None:
        """Something that happened once."""
        self._json(self._events, t_ns, asdict(event))

    def log_input(self, t_ns: int, data: Mapping[str, Any]) -> None:
        """Something replay needs beside the frames. Raises RecordingError when it is no plain JSON."""
        self._json(self._inputs, t_ns, data)

    def _json(self, channel: Channel, t_ns: int, data: Mapping[str, Any]) -> None:
        try:
            text = json.dumps(data, allow_nan=False)
        except (TypeError, ValueError) as error:
            raise RecordingError(f"{channel.topic()}: not plain JSON ({error}); write null for no answer") from None
        channel.log(text, log_time=t_ns)


def _json_channel(topic: str, name: str, context: Context) -> Channel:
    schema = Schema(name=name, encoding="jsonschema", data=json.dumps({"title": name, "type": "object"}).encode())
    return Channel(topic, schema=schema, message_encoding="json", context=context)


def root_link(urdf: str | None) -> str:
    """Name of the link that is nobody's child. Raises RecordingError when the text is not a URDF."""
    if not urdf:
        return "base_link"
    try:
        robot = ElementTree.fromstring(urdf)
    except ElementTree.ParseError as error:
        raise RecordingError(f"the URDF is not well-formed XML: {error}") from None
    children = {child.get("link") for child in robot.iterfind("joint/child")}
    roots = [link.get("name", "") for link in robot.iterfind("link") if link.get("name") not in children]
    if len(roots) != 1:
        raise RecordingError(f"the URDF must have one root link, found {len(roots)}")
    return roots[0]
