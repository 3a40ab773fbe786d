"""What a recording says happened: inputs in order, and tracking row, robot joints and chassis pose of each frame."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from teleop.errors import RecordingError
from teleop.frames import DepthFrame
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
        self._robot_number = _numbers(source, topics.JOINT_STATES)
        self._transforms = _numbers(source, topics.TF)

    def at(self, t_ns: int) -> dict[str, Any] | None:
        """The tracking row, with ``robot`` (joint name -> rad or m) and ``base`` added; None if there is none."""
        row_number, number = self._row_number.get(t_ns), self._robot_number.get(t_ns)
        if row_number is None or number is None:
            return None
        row = self._source.row(topics.TRACK, row_number)
        joints = self._source.file.message(topics.JOINT_STATES, number).joints
        moves = self._transforms.get(t_ns)
        found = [] if moves is None else self._source.file.message(topics.TF, moves).transforms
        if not found:
            return None
        pose = found[0]
        move, turn = pose.translation, pose.rotation
        base = {"x": move.x, "y": move.y, "qz": turn.z, "qw": turn.w}
        return row | {"robot": {joint.name: joint.position for joint in joints}, "base": base}


def _numbers(source: McapSource, topic: str) -> dict[int, int]:
    """Time -> running number of the topic's messages."""
    return {int(t_ns): number for number, t_ns in enumerate(source.file.topics[topic].t_ns)}
