"""Recordings are MCAP files with Foxglove's protobuf schemas; this writes one.

Chunks are closed at least every half second of recording time, so that a crash loses at most that much.
"""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from foxglove import Channel, Context, Schema, open_mcap
from foxglove.channels import (
    CameraCalibrationChannel,
    CompressedImageChannel,
    FrameTransformsChannel,
    JointStatesChannel,
    RawImageChannel,
    SceneUpdateChannel,
)
from foxglove.mcap import MCAPCompression, MCAPWriteOptions

from robot_sim.state import RobotState
from teleop.errors import FrameError, RecordingError
from teleop.frames import Camera, DepthFrame
from teleop.intent_types import Event
from teleop.recording import messages, topics
from teleop.recording.output import OutputFile
from teleop.skeleton import Skeleton
from teleop.sources.jpeg import encode_jpeg

CHUNK_BYTES = 4 << 20
"""Six depth images of 640x480: larger chunks are not smaller on disk, and slow a seek down."""
FLUSH_NS = 500_000_000
MAX_T_NS = 2**32 * 1_000_000_000
"""Foxglove's time stamps hold 32 bits of seconds."""


def software_version() -> str:
    """Version of the installed distribution."""
    try:
        return version("greenhouse-teleop")
    except PackageNotFoundError:
        return "unknown"


class McapWriter:
    """Writes one recording. Not thread-safe; times of one topic must not run backwards.

    Every ``write_`` raises RecordingError when the file can no longer be written (disk full); what was flushed
    before stays readable.
    """

    def __init__(
        self,
        path: Path | str,
        camera: Camera,
        *,
        source_uri: str,
        urdf: str | None = None,
        color: bool = True,
        metadata: Mapping[str, str] | None = None,
        jpeg_quality: int = 90,
        compression_level: int = 0,
    ) -> None:
        """Create ``path`` (which must not exist yet).

        urdf: text for /robot_description. color: False leaves colour out (privacy). metadata: more keys for the
        ``teleop`` record. compression_level: zstd's, 0 is its default. Raises RecordingError.
        """
        self.path = Path(path)
        self._camera = camera
        self._color = color
        self._jpeg_quality = jpeg_quality
        self._urdf = urdf
        self._base_frame = _root_link(urdf) if urdf else "base_link"
        self._last_depth_ns = -1
        self._last_flush_ns: int | None = None
        self._color_info_due = True
        self._closed = False

        self._file = OutputFile(self.path)
        context = Context()
        self._context = context
        options = MCAPWriteOptions(
            compression=MCAPCompression.Zstd,
            compression_level=compression_level,
            compression_threads=0,
            chunk_size=CHUNK_BYTES,
        )
        self._mcap = open_mcap(self._file, context=context, writer_options=options)
        self._depth = RawImageChannel(topics.DEPTH, context=context)
        self._depth_info = CameraCalibrationChannel(topics.DEPTH_INFO, context=context)
        self._color_image = CompressedImageChannel(topics.COLOR, context=context)
        self._color_info = CameraCalibrationChannel(topics.COLOR_INFO, context=context)
        self._joint_states = JointStatesChannel(topics.JOINT_STATES, context=context)
        self._tf = FrameTransformsChannel(topics.TF, context=context)
        self._skeleton = SceneUpdateChannel(topics.SKELETON, context=context)
        self._description = _json_channel(topics.ROBOT_DESCRIPTION, "std_msgs/String", context)
        self._track = _json_channel(topics.TRACK, "teleop.Track", context)
        self._events = _json_channel(topics.EVENTS, "teleop.Event", context)
        self._inputs = _json_channel(topics.INPUTS, "teleop.Input", context)
        # First in the file, so that a recording cut off by a crash still says how it was made.
        self._mcap.write_metadata(topics.METADATA, self._metadata(source_uri, metadata or {}))
        self._check()

    def _metadata(self, source_uri: str, more: Mapping[str, str]) -> dict[str, str]:
        record = {
            topics.KEY_FORMAT: str(topics.FORMAT_VERSION),
            topics.KEY_SOFTWARE: software_version(),
            topics.KEY_MIRRORED: "true" if self._camera.mirrored else "false",
            topics.KEY_SOURCE: source_uri,
        }
        if self._camera.color is not None:
            record[topics.KEY_COLOR] = json.dumps(asdict(self._camera.color))
        if self._camera.T_color_depth is not None:
            record[topics.KEY_T_COLOR_DEPTH] = json.dumps(self._camera.T_color_depth)
        clash = sorted(set(record) & set(more))
        if clash:
            raise RecordingError(f"metadata keys {', '.join(clash)} are set by the writer itself; use other names")
        return record | dict(more)

    def write_frame(self, frame: DepthFrame) -> None:
        """Depth, camera info and colour of one frame. Frames must have increasing times and the writer's camera."""
        if frame.camera != self._camera:
            raise RecordingError("the camera changed during the recording; start a new recording for the new camera")
        if frame.t_ns <= self._last_depth_ns:
            raise RecordingError(
                f"frame times must increase: {frame.t_ns} ns after {self._last_depth_ns} ns; start a new recording"
            )
        t_ns = self._begin(frame.t_ns)
        self._last_depth_ns = t_ns
        self._depth.log(messages.depth_image(frame), log_time=t_ns)
        if self._color and frame.color_rgb is not None:
            try:
                jpeg = frame.color_jpeg or encode_jpeg(frame.color_rgb, self._jpeg_quality)
            except FrameError as error:
                raise RecordingError(str(error)) from None
            self._color_image.log(messages.color_image(t_ns, jpeg), log_time=t_ns)
            if self._color_info_due:
                k = messages.color_intrinsics(self._camera, frame.color_rgb)
                self._color_info.log(messages.camera_info(t_ns, k, topics.COLOR_FRAME), log_time=t_ns)
                self._color_info_due = False
        self._check()

    def write_row(self, t_ns: int, row: Mapping[str, Any]) -> None:
        """One row of ``teleop track``."""
        self._json(self._track, t_ns, row)

    def write_skeleton(self, t_ns: int, skeleton: Skeleton | None) -> None:
        """The skeleton as a 3-D scene; None takes the last one away."""
        self._skeleton.log(messages.skeleton_scene(t_ns, skeleton, self._camera), log_time=self._begin(t_ns))
        self._check()

    def write_robot(self, t_ns: int, state: RobotState) -> None:
        """Joint positions and the pose of the chassis."""
        self._begin(t_ns)
        self._joint_states.log(messages.joint_states(t_ns, state), log_time=t_ns)
        self._tf.log(messages.base_transform(t_ns, state, self._base_frame), log_time=t_ns)
        self._check()

    def write_event(self, event: Event) -> None:
        """Something that happened once."""
        self._json(self._events, event.t_ns, asdict(event))

    def write_input(self, t_ns: int, data: Mapping[str, Any]) -> None:
        """Something replay needs beside the frames."""
        self._json(self._inputs, t_ns, data)

    def flush(self) -> None:
        """Close the chunk and hand it to the operating system."""
        try:
            self._mcap.flush()
        except RuntimeError as error:
            raise self._failure(error) from None
        self._check()

    def close(self) -> None:
        """Write the index and close the file; safe to call twice. Raises RecordingError when the disk is full."""
        if self._closed:
            return
        self._closed = True
        try:
            self._mcap.close()
        except RuntimeError as error:
            raise self._failure(error) from None
        finally:
            self._file.close()
        self._check()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _begin(self, t_ns: int) -> int:
        """Check the time of a message, flush when due, and put what every chunk repeats at its start."""
        if self._closed:
            raise RecordingError(f"{self.path} is closed already")
        if not 0 <= t_ns < MAX_T_NS:
            raise RecordingError(f"times in a recording must be from 0 to below {MAX_T_NS} ns, got {t_ns} ns")
        first = self._last_flush_ns is None
        if self._last_flush_ns is None or t_ns - self._last_flush_ns >= FLUSH_NS:
            if not first:
                self.flush()
            self._last_flush_ns = t_ns
            self._color_info_due = True
            self._depth_info.log(messages.camera_info(t_ns, self._camera.depth, topics.DEPTH_FRAME), log_time=t_ns)
        if first and self._urdf:
            self._description.log(json.dumps({"data": self._urdf}), log_time=t_ns)
        return t_ns

    def _json(self, channel: Channel, t_ns: int, data: Mapping[str, Any]) -> None:
        try:
            text = json.dumps(data, allow_nan=False)
        except (TypeError, ValueError) as error:
            raise RecordingError(f"{channel.topic()}: not plain JSON ({error}); write null for no answer") from None
        channel.log(text, log_time=self._begin(t_ns))
        self._check()

    def _check(self) -> None:
        if self._file.error is not None:
            raise self._failure(self._file.error)

    def _failure(self, error: Exception) -> RecordingError:
        cause = self._file.error or error
        text = cause.strerror if isinstance(cause, OSError) and cause.strerror else str(cause)
        return RecordingError(f"cannot write {self.path}: {text}; what was recorded until then can be opened")


def _json_channel(topic: str, name: str, context: Context) -> Channel:
    schema = Schema(name=name, encoding="jsonschema", data=json.dumps({"title": name, "type": "object"}).encode())
    return Channel(topic, schema=schema, message_encoding="json", context=context)


def _root_link(urdf: str) -> str:
    """Name of the link that is nobody's child. Raises RecordingError when the text is not a URDF."""
    try:
        robot = ElementTree.fromstring(urdf)
    except ElementTree.ParseError as error:
        raise RecordingError(f"the URDF is not well-formed XML: {error}") from None
    children = {child.get("link") for child in robot.iterfind("joint/child")}
    roots = [link.get("name", "") for link in robot.iterfind("link") if link.get("name") not in children]
    if len(roots) != 1:
        raise RecordingError(f"the URDF must have one root link, found {len(roots)}")
    return roots[0]
