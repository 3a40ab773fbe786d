"""What a recording says happened: inputs in order, and tracking row, robot joints and chassis pose of each frame."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from teleop.errors import RecordingError
from teleop.frames import DepthFrame
from teleop.modes import IN_CONTROL
from teleop.recording import topics
from teleop.recording.mcap_source import McapSource


class RecordedFrames:
    """The frames of a recording, asked for by their times in increasing order."""

    def __init__(self, source: McapSource) -> None:
        self._frames: Iterator[DepthFrame] = source.frames()
        self._next: DepthFrame | None = next(self._frames, None)

    def at(self, t_ns: int) -> DepthFrame | None:
        """The frame of exactly that time, or None when the recording does not hold it."""
        while self._next is not None and self._next.t_ns < t_ns:
            self._next = next(self._frames, None)
        return self._next if self._next is not None and self._next.t_ns == t_ns else None


@dataclass(frozen=True, slots=True)
class RecordedPose:
    """Where the robot was. base: x, y [m] and sine and cosine of half the yaw; joint_rad: rad, m for prismatic ones."""

    x_m: float
    y_m: float
    qz: float
    qw: float
    joint_rad: Mapping[str, float]

    @property
    def yaw_rad(self) -> float:
        """Heading of the chassis."""
        return 2.0 * math.atan2(self.qz, self.qw)


class RecordedRobot:
    """The robot's poses, asked for by the times of their frames."""

    def __init__(self, source: McapSource) -> None:
        self._source = source
        held = topics.JOINT_STATES in source.file.topics and topics.TF in source.file.topics
        self._joints = _numbers(source, topics.JOINT_STATES) if held else {}
        self._transforms = _numbers(source, topics.TF) if held else {}

    def at(self, t_ns: int) -> RecordedPose | None:
        """The pose of exactly that time, or None when the recording does not hold it."""
        joints, moves = self._joints.get(t_ns), self._transforms.get(t_ns)
        if joints is None or moves is None:
            return None
        states = self._source.file.message(topics.JOINT_STATES, joints).joints
        found = self._source.file.message(topics.TF, moves).transforms
        if not found:
            return None
        move, turn = found[0].translation, found[0].rotation
        return RecordedPose(move.x, move.y, turn.z, turn.w, {joint.name: joint.position for joint in states})


class RecordedModes:
    """Whether the operator was in control, asked for by the times of the frames."""

    def __init__(self, source: McapSource) -> None:
        self._source = source
        self._row_number = _numbers(source, topics.TRACK) if topics.TRACK in source.file.topics else {}

    def in_control(self, t_ns: int) -> bool:
        """False where nothing was recorded."""
        number = self._row_number.get(t_ns)
        return number is not None and self._source.row(topics.TRACK, number).get("mode") in IN_CONTROL


class RecordedAnswers:
    """The answers of a recording, asked for by the times of their frames."""

    def __init__(self, source: McapSource) -> None:
        """Raises RecordingError when nothing was recorded beside the frames."""
        lacking = [
            t for t in (topics.TRACK, topics.INPUTS, topics.JOINT_STATES, topics.TF) if t not in source.file.topics
        ]
        if lacking:
            raise RecordingError(
                f"{source.path} has no {', '.join(lacking)}, so there is nothing to verify; "
                f"make a recording that has with 'teleop record {source.path} OUT.mcap'"
            )
        self._source = source
        self._row_number = _numbers(source, topics.TRACK)
        self._robot = RecordedRobot(source)

    def at(self, t_ns: int) -> dict[str, Any] | None:
        """The tracking row, with ``robot`` (joint name -> rad or m) and ``base`` added; None if there is none."""
        row_number, pose = self._row_number.get(t_ns), self._robot.at(t_ns)
        if row_number is None or pose is None:
            return None
        base = {"x": pose.x_m, "y": pose.y_m, "qz": pose.qz, "qw": pose.qw}
        return self._source.row(topics.TRACK, row_number) | {"robot": dict(pose.joint_rad), "base": base}


def _numbers(source: McapSource, topic: str) -> dict[int, int]:
    """Time -> running number of the topic's messages."""
    return {int(t_ns): number for number, t_ns in enumerate(source.file.topics[topic].t_ns)}
