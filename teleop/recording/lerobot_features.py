"""One frame of a session as the vectors of a LeRobot dataset: state, action, skeleton, angles."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from teleop.joints import JOINT_NAMES
from teleop.recording.csv_table import ANGLES
from teleop.recording.recorded import RecordedPose

STATE: Final = "observation.state"
SKELETON: Final = "observation.skeleton"
CONFIDENCE: Final = "observation.skeleton_confidence"
BODY_ANGLES: Final = "observation.body_angles"
TIME: Final = "observation.time_ns"
COLOR: Final = "observation.images.color"
DEPTH: Final = "observation.images.depth"
ACTION: Final = "action"

_ARM_ACTIONS: Final = tuple(
    (arm, angle) for arm in ("right_arm", "left_arm", "rear_arm") for angle in ("c1_deg", "c2_deg", "elbow_deg")
)
_PLAIN_ACTIONS: Final = (
    "drive_m_s",
    "turn_rad_s",
    "lift_m",
    "disc_rad",
    "gripper_open",
    "cutter_closed",
    "spray_on",
)
ACTION_NAMES: Final = (*(f"{arm}_{angle}" for arm, angle in _ARM_ACTIONS), *_PLAIN_ACTIONS)
BASE_NAMES: Final = ("base_x_m", "base_y_m", "base_yaw_rad")

Vector = npt.NDArray[np.float32]


class Vectors:
    """Rows and poses in order to float32 vectors. Where there is no answer the last one stands, at first 0:

    a policy cannot be trained on numbers that are none, and a held robot does keep its set-points.
    """

    def __init__(self, robot_joints: Sequence[str]) -> None:
        """robot_joints: names of the recorded robot's joints; none when there was no robot."""
        self._robot_joints = tuple(robot_joints)
        self._last = {name: np.zeros(len(names), np.float32) for name, names in self.names().items()}

    def names(self) -> dict[str, tuple[str, ...]]:
        """Feature -> names of its numbers."""
        state = {STATE: (*self._robot_joints, *BASE_NAMES)} if self._robot_joints else {}
        return state | {
            ACTION: ACTION_NAMES,
            SKELETON: tuple(f"{joint}_{axis}_m" for joint in JOINT_NAMES for axis in "xyz"),
            CONFIDENCE: JOINT_NAMES,
            BODY_ANGLES: tuple(f"{name}_deg" for name in ANGLES),
        }

    def of(self, row: Mapping[str, Any], pose: RecordedPose | None) -> dict[str, Vector]:
        """The vectors of one frame."""
        command, joints = row["command"], row["joints"]
        values: dict[str, list[Any]] = {
            ACTION: [
                *((command.get(arm) or {}).get(angle) for arm, angle in _ARM_ACTIONS),
                *(command.get(name) for name in _PLAIN_ACTIONS),
            ],
            SKELETON: [c for name in JOINT_NAMES for c in joints.get(name) or (None, None, None)],
            CONFIDENCE: [row["confidence"].get(name, 0.0) for name in JOINT_NAMES],
            BODY_ANGLES: [row["angles"].get(name) for name in ANGLES],
        }
        if self._robot_joints:
            known = pose is not None
            at = pose.joint_rad if pose is not None else {}
            base = (pose.x_m, pose.y_m, pose.yaw_rad) if pose is not None else (None, None, None)
            values[STATE] = [*(at.get(name) if known else None for name in self._robot_joints), *base]
        return {name: self._filled(name, given) for name, given in values.items()}

    def _filled(self, name: str, given: Sequence[Any]) -> Vector:
        numbers = np.array([math.nan if value is None else float(value) for value in given], np.float32)
        filled = np.where(np.isfinite(numbers), numbers, self._last[name]).astype(np.float32)
        self._last[name] = filled
        return filled


class Statistics:
    """Extremes, mean and standard deviation of one feature, per number or per colour, kept while frames come."""

    def __init__(self, size: int) -> None:
        self.count = 0
        self._least, self._most = np.full(size, np.inf), np.full(size, -np.inf)
        self._sum, self._squares, self._samples = np.zeros(size), np.zeros(size), 0

    def add(self, samples: npt.NDArray[Any]) -> None:
        """Samples (N, size) of one frame."""
        x = samples.astype(np.float64)
        self.count += 1
        self._samples += len(x)
        self._least, self._most = np.minimum(self._least, x.min(axis=0)), np.maximum(self._most, x.max(axis=0))
        self._sum, self._squares = self._sum + x.sum(axis=0), self._squares + (x * x).sum(axis=0)

    def merge(self, other: Statistics) -> None:
        """Take another one's samples in."""
        self.count += other.count
        self._samples += other._samples
        self._least, self._most = np.minimum(self._least, other._least), np.maximum(self._most, other._most)
        self._sum, self._squares = self._sum + other._sum, self._squares + other._squares

    def as_json(self, image: bool) -> dict[str, Any]:
        """LeRobot's form; of an image one value per channel, shaped (channels, 1, 1)."""
        mean = self._sum / self._samples
        std = np.sqrt(np.maximum(self._squares / self._samples - mean**2, 0.0))
        values = {"min": self._least, "max": self._most, "mean": mean, "std": std}
        table: dict[str, Any] = {
            name: [[[float(v)]] for v in value] if image else [float(v) for v in value]
            for name, value in values.items()
        }
        return table | {"count": [self.count]}
