"""A recording as a source of frames: by topic, by time, with or without colour."""

from __future__ import annotations

import json
import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from teleop.errors import FrameError, RecordingError
from teleop.frames import Camera, ColorImage, DepthFrame, DepthImage, Intrinsics, kinect_v1
from teleop.recording import topics
from teleop.recording.mcap_file import McapFile
from teleop.recording.migrate import migrated
from teleop.sources.base import SourceInfo
from teleop.sources.nearest import NearestInTime
from teleop.sources.picture import decode_image

_log = logging.getLogger(__name__)
_MAX_SIDE = 16384
_JPEG = b"\xff\xd8"


class McapSource:
    """Frames of an MCAP file with the topics of ``teleop.recording.topics``, written by us or by others."""

    def __init__(self, path: Path | str) -> None:
        """Open. Raises RecordingError: missing, not an MCAP, empty, without 16-bit depth."""
        self.path = Path(path)
        self.file = McapFile(self.path)
        try:
            try:
                self.metadata = migrated(self.file.metadata(topics.METADATA))
            except RecordingError as error:
                raise RecordingError(f"{self.path}: {error}") from None
            if topics.DEPTH not in self.file.topics:
                raise RecordingError(self._no_depth())
            self._t_ns = self.file.topics[topics.DEPTH].t_ns
            self._info = self._describe()
        except BaseException:
            self.file.close()
            raise

    @property
    def info(self) -> SourceInfo:
        """What is known of the recording."""
        return self._info

    @property
    def start_ns(self) -> int:
        """Time of the first frame [ns]."""
        return int(self._t_ns[0])

    @property
    def truncated(self) -> str | None:
        """Why the file ends early, or None when it is whole."""
        return self.file.truncated

    def frames(self, from_s: float = 0.0) -> Iterator[DepthFrame]:
        """Frames from ``from_s`` seconds after the first; skips to the chunk without reading what lies before."""
        first = int(np.searchsorted(self._t_ns, self._t_ns[0] + round(max(from_s, 0.0) * 1e9)))
        color = _ColorReader(self.file, self._t_ns)
        for number in range(first, len(self._t_ns)):
            yield self._frame(number, color)

    def rows(self, topic: str, from_s: float = 0.0) -> Iterator[tuple[int, dict[str, Any]]]:
        """Times and objects of a JSON topic, such as /teleop/track; nothing when the recording has none of it."""
        index = self.file.topics.get(topic)
        if index is None:
            return
        first = int(np.searchsorted(index.t_ns, self._t_ns[0] + round(max(from_s, 0.0) * 1e9))) if from_s > 0 else 0
        for number in range(first, len(index.t_ns)):
            yield int(index.t_ns[number]), _json_object(self.file, topic, number)

    def row(self, topic: str, number: int) -> dict[str, Any]:
        """One object of a JSON topic that the recording has, by its running number."""
        return _json_object(self.file, topic, number)

    def urdf(self) -> str | None:
        """The robot description, if the recording has one."""
        if topics.ROBOT_DESCRIPTION not in self.file.topics:
            return None
        return str(_json_object(self.file, topics.ROBOT_DESCRIPTION, 0).get("data", ""))

    def close(self) -> None:
        """Close the file; safe to call twice."""
        self.file.close()

    def _no_depth(self) -> str:
        if not self.file.topics:
            return f"{self.path} holds no complete chunk of messages"
        return f"{self.path} has no depth on {topics.DEPTH}; its topics are: {', '.join(sorted(self.file.topics))}"

    def _describe(self) -> SourceInfo:
        depth = self._depth_image(0)
        camera = self._camera(depth.shape[1], depth.shape[0])
        span_ns = int(self._t_ns[-1] - self._t_ns[0])
        return SourceInfo(
            uri=str(self.path),
            kind="mcap",
            camera=camera,
            live=False,
            frame_count=len(self._t_ns),
            duration_s=span_ns * 1e-9,
            has_color=topics.COLOR in self.file.topics,
        )

    def _camera(self, width: int, height: int) -> Camera:
        said = self._metadata_camera()
        depth = said.get("depth")
        k = self._intrinsics(topics.DEPTH_INFO) if depth is None else self._plain(depth)
        if k is None:
            _log.warning("%s has no %s; taking a Kinect v1's", self.path, topics.DEPTH_INFO)
            k = kinect_v1(width, height)
        if (k.width, k.height) != (width, height):
            raise RecordingError(
                f"{self.path}: depth images are {width}x{height} but camera_info says {k.width}x{k.height}"
            )
        if topics.KEY_FORMAT not in self.metadata:
            return Camera(k, False, self._intrinsics(topics.COLOR_INFO))
        color = said.get("color")
        return Camera(
            k,
            said.get("mirrored") is True,
            None if color is None else self._plain(color),
            self._matrix(said.get("T_color_depth")),
        )

    def _intrinsics(self, topic: str) -> Intrinsics | None:
        if topic not in self.file.topics:
            return None
        info = self.file.message(topic, 0)
        matrix = list(getattr(info, "K", []))
        if len(matrix) != 9:
            raise RecordingError(f"{self.path}: {topic} has no 3x3 matrix K")
        try:
            return Intrinsics(matrix[0], matrix[4], matrix[2], matrix[5], info.width, info.height)
        except FrameError as error:
            raise RecordingError(f"{self.path}: {topic}: {error}") from None

    def _metadata_camera(self) -> dict[str, Any]:
        try:
            said = json.loads(self.metadata.get(topics.KEY_CAMERA, "{}"))
        except ValueError as error:
            raise self._damaged(error) from None
        if not isinstance(said, dict):
            raise self._damaged("it is no object")
        return said

    def _plain(self, numbers: Any) -> Intrinsics:
        try:
            return Intrinsics(**numbers)
        except (TypeError, ValueError, FrameError) as error:
            raise self._damaged(error) from None

    def _matrix(self, rows: Any) -> tuple[tuple[float, ...], ...] | None:
        if rows is None:
            return None
        try:
            matrix = np.array(rows, dtype=np.float64).reshape(4, 4)
        except (ValueError, TypeError) as error:
            raise self._damaged(error) from None
        return tuple(tuple(float(x) for x in row) for row in matrix)

    def _damaged(self, why: object) -> RecordingError:
        return RecordingError(f"{self.path}: metadata '{topics.KEY_CAMERA}' is damaged: {why}")

    def _frame(self, number: int, color: _ColorReader) -> DepthFrame:
        t_ns = int(self._t_ns[number])
        try:
            return DepthFrame(t_ns, self._depth_image(number), self._info.camera, *color.nearest(t_ns, number))
        except FrameError as error:
            raise RecordingError(f"{self.path}: frame {number}: {error}") from None

    def _depth_image(self, number: int) -> DepthImage:
        image = self.file.message(topics.DEPTH, number)
        encoding = getattr(image, "encoding", "")
        if encoding != topics.DEPTH_ENCODING:
            raise RecordingError(
                f"{self.path}: depth is encoded as '{encoding}', it must be {topics.DEPTH_ENCODING} in millimetres"
            )
        width, height, step = image.width, image.height, image.step or 2 * image.width
        data = image.data
        sizes_ok = 0 < width <= _MAX_SIDE and 0 < height <= _MAX_SIDE and step >= 2 * width and step % 2 == 0
        if not sizes_ok or len(data) < step * height:
            raise RecordingError(
                f"{self.path}: depth image {number} says {width}x{height} with {step} bytes a row but holds {len(data)}"
            )
        rows = np.frombuffer(data, dtype="<u2", count=step // 2 * height).reshape(height, step // 2)
        return rows[:, :width].astype(np.uint16, copy=False)


class _ColorReader:
    """The colour image nearest in time to a depth image; the last one stays decoded."""

    def __init__(self, file: McapFile, depth_t_ns: npt.NDArray[np.int64]) -> None:
        self._file = file
        index = file.topics.get(topics.COLOR)
        t_ns = index.t_ns if index is not None else np.zeros(0, dtype=np.int64)
        self._nearest = NearestInTime(t_ns, depth_t_ns)
        self._last: tuple[int, ColorImage, bytes | None] | None = None

    def nearest(self, t_ns: int, seq: int) -> tuple[ColorImage | None, int, bytes | None]:
        """RGB image (h, w, 3) or None when none lies near enough; the frame's number; the JPEG if it was one."""
        number = self._nearest.index(t_ns)
        if number is None:
            return None, seq, None
        if self._last is None or self._last[0] != number:
            self._last = (number, *self._decode(number))
        return self._last[1], seq, self._last[2]

    def _decode(self, number: int) -> tuple[ColorImage, bytes | None]:
        message = self._file.message(topics.COLOR, number)
        packed = bytes(getattr(message, "data", b""))
        image = decode_image(packed, cv2.IMREAD_COLOR)
        if image is None:
            raise RecordingError(f"{self._file.path}: colour image {number} cannot be decoded")
        rgb = cv2.cvtColor(image, cv2.COLOR_BGR2RGB)
        rgb.flags.writeable = False
        return rgb.astype(np.uint8, copy=False), packed if packed.startswith(_JPEG) else None


def _json_object(file: McapFile, topic: str, number: int) -> dict[str, Any]:
    try:
        value = json.loads(file.payload(topic, number))
    except ValueError as error:
        raise RecordingError(f"{file.path}: message {number} of {topic} is not JSON: {error}") from None
    if not isinstance(value, dict):
        raise RecordingError(f"{file.path}: message {number} of {topic} is not a JSON object")
    return value
