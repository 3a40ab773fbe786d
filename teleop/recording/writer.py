"""Recordings are MCAP files with Foxglove's protobuf schemas; this writes one.

The first chunk is closed behind the first frame and the others at least every half second of recording time, so that
a crash loses no more than that. A disk that is full ends the file with its closing records all the same.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from foxglove import Context, open_mcap
from foxglove.mcap import MCAPCompression, MCAPWriteOptions

from robot_sim.state import RobotState
from teleop.config.recording import RecordingConfig
from teleop.errors import RecordingError
from teleop.frames import Camera, DepthFrame
from teleop.intent_types import Event
from teleop.recording import topics
from teleop.recording.channels import Channels, root_link
from teleop.recording.mcap_file import McapFile
from teleop.recording.output import OutputFile
from teleop.recording.seal import seal
from teleop.skeleton import Skeleton
from teleop.software import software_version

MAX_T_NS = 2**32 * 1_000_000_000
"""Foxglove's time stamps hold 32 bits of seconds."""


class McapWriter:
    """Writes one recording. Not thread-safe; times of one topic must not run backwards.

    Every ``write_`` raises RecordingError when the file can no longer be written (disk full); what was flushed
    before stays readable, by every reader once the writer is closed.
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
        config: RecordingConfig | None = None,
    ) -> None:
        """Create ``path`` (which must not exist yet).

        urdf: text for /robot_description. color: the source has colour; it is recorded unless ``config`` leaves it
        out. metadata: more keys for the ``teleop`` record. Raises RecordingError.
        """
        config = config or RecordingConfig()
        self.path = Path(path)
        self._camera = camera
        self._color = color and config.color
        self._flush_ns = round(config.flush_s * 1e9)
        self._last_depth_ns = -1
        self._next_flush_ns: int | None = None
        self._chunk_begins = False
        self._color_info_due = True
        self._closed = False

        base_frame = root_link(urdf)
        self._file = OutputFile(self.path)
        self._context = Context()
        options = MCAPWriteOptions(
            compression=MCAPCompression.Zstd,
            compression_level=config.compression_level,
            compression_threads=0,
            chunk_size=config.chunk_mb << 20,
        )
        self._mcap = open_mcap(self._file, context=self._context, writer_options=options)
        self._channels = Channels(self._context, urdf, base_frame, config.jpeg_quality)
        kept = "none" if not color else "yes" if config.color else "no"
        # First in the file, so that a recording cut off by a crash still says how it was made.
        self._mcap.write_metadata(topics.METADATA, self._metadata(source_uri, kept, metadata or {}))
        self._check()

    def _metadata(self, source_uri: str, kept: str, more: Mapping[str, str]) -> dict[str, str]:
        record = {
            topics.KEY_FORMAT: str(topics.FORMAT_VERSION),
            topics.KEY_SOFTWARE: software_version(),
            topics.KEY_SOURCE: source_uri,
            topics.KEY_CAMERA: json.dumps(asdict(self._camera)),
            topics.KEY_COLOR_KEPT: kept,
        }
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
        self._channels.log_depth(t_ns, frame)
        if self._color and frame.color_rgb is not None:
            self._channels.log_color(t_ns, frame)
            if self._color_info_due:
                self._channels.log_color_info(t_ns, frame)
                self._color_info_due = False
        self._check()

    def write_row(self, t_ns: int, row: Mapping[str, Any]) -> None:
        """One row of ``teleop track``."""
        self._channels.log_row(self._begin(t_ns), row)
        self._check()

    def write_skeleton(self, t_ns: int, skeleton: Skeleton | None) -> None:
        """The skeleton as a 3-D scene; None takes the last one away."""
        self._channels.log_skeleton(self._begin(t_ns), skeleton, self._camera)
        self._check()

    def write_robot(self, t_ns: int, state: RobotState) -> None:
        """Joint positions and the pose of the chassis."""
        self._channels.log_robot(self._begin(t_ns), state)
        self._check()

    def write_event(self, event: Event) -> None:
        """Something that happened once."""
        self._channels.log_event(self._begin(event.t_ns), event)
        self._check()

    def write_input(self, t_ns: int, data: Mapping[str, Any]) -> None:
        """Something replay needs beside the frames."""
        self._channels.log_input(self._begin(t_ns), data)
        self._check()

    def flush(self) -> None:
        """Close the chunk and hand it to the operating system."""
        try:
            self._mcap.flush()
        except RuntimeError as error:
            raise self._failure(error) from None
        self._chunk_begins = True
        self._check()

    def close(self) -> None:
        """Write the index and close the file; safe to call twice.

        Raises RecordingError when the disk is full; the file has its index then, too, as far as it got.
        """
        if self._closed:
            return
        self._closed = True
        try:
            self._mcap.close()
        except RuntimeError as error:
            raise self._failure(error) from None
        finally:
            self._file.close()
            if self._file.error is not None:
                _seal_what_is_there(self.path)
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
        first = self._next_flush_ns is None
        if self._next_flush_ns is None or self._chunk_begins or t_ns >= self._next_flush_ns:
            if not first and not self._chunk_begins:
                self.flush()
            self._chunk_begins = False
            # the chunk of the first frame is closed as soon as another time begins
            self._next_flush_ns = t_ns + (1 if first else self._flush_ns)
            self._color_info_due = True
            self._channels.log_depth_info(t_ns, self._camera)
        if first:
            self._channels.log_description(t_ns)
        return t_ns

    def _check(self) -> None:
        if self._file.error is not None:
            raise self._failure(self._file.error)

    def _failure(self, error: Exception) -> RecordingError:
        cause = self._file.error or error
        text = cause.strerror if isinstance(cause, OSError) and cause.strerror else str(cause)
        return RecordingError(f"cannot write {self.path}: {text}; what was recorded until then can be opened")


def _seal_what_is_there(path: Path) -> None:
    """Closing records on a full disk: the torn chunk's space is free, and if it is too little, the last one's too."""
    for spared in range(3):
        with suppress(RecordingError, OSError):
            file = McapFile(path)
            file.close()
            found = file.scan
            if spared:
                found.data_end = min(chunk.start for chunk in found.chunks[-spared:])
                del found.chunks[-spared:]
            seal(path, found)
            return
