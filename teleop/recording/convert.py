"""From any source to a recording or an RGB-D folder, frame by frame; the output appears only when it is complete."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from teleop.config.recording import RecordingConfig
from teleop.errors import RecordingError
from teleop.frames import Camera, DepthFrame
from teleop.recording.fakenect_writer import FakenectWriter
from teleop.recording.resumable import finish, prepare, remove
from teleop.recording.rgbd_writer import RgbdFolderWriter
from teleop.recording.writer import McapWriter
from teleop.sources.base import Source

_FILES = (".mcap", ".csv", ".mp4")
_DATASET_CONTENT = ("data", "videos", "meta")
_FOLDER_CONTENT = ("depth", "rgb", "depth.txt", "rgb.txt", "camera.json", "INDEX.txt")


class FrameSink(Protocol):
    """Where frames go."""

    def write_frame(self, frame: DepthFrame) -> None:
        """Take one frame."""
        ...

    def close(self) -> None:
        """Finish."""
        ...


class ResumableSink(FrameSink, Protocol):
    """One that can go on after an interruption. frames_done: how many frames it holds already."""

    frames_done: int

    def skip(self, frame: DepthFrame) -> None:
        """Pass over a frame that it holds."""
        ...


def convert(
    source: Source,
    output: Path,
    *,
    force: bool = False,
    color: bool = True,
    from_s: float = 0.0,
    seconds: float | None = None,
    on_frame: Callable[[DepthFrame], None] | None = None,
) -> int:
    """Write the source's frames to ``output``: ``.mcap`` is a recording, ``.fakenect`` a dump folder that libfreenect's
    fakenect plays, any other name an RGB-D folder.

    color: False leaves colour out. from_s, seconds: the part to take. force: replace an output that exists.
    on_frame is called after each frame. Returns the number of frames. Raises TeleopError; then no output is left.

    Folders of a recorded source go on where an interruption (Ctrl-C, a kill, a power cut) left them, beside the output
    as NAME.partial; files begin anew. Either way the result is the same as without the interruption.
    """
    if source.info.live and seconds is None:
        raise RecordingError(f"{source.info.uri} is live and has no end; say how many seconds to take")
    refuse_overwrite(output, source, force)
    partial = output.with_name(output.name + ".partial")
    resumable = output.suffix.lower() != ".mcap" and not source.info.live
    kept = False
    try:
        if resumable:
            prepare(partial, source.info.uri, {"color": color, "from_s": from_s, "seconds": seconds})
        else:
            remove(partial)
        count = _copy(source, open_sink(partial, output, source, color), color, from_s, seconds, on_frame)
        if count == 0:
            raise RecordingError(f"{source.info.uri} has no frames from {from_s} s on; nothing was written")
        finish(partial)
        if force:
            remove(output)
        elif output.is_dir():
            output.rmdir()
        partial.replace(output)
    except OSError as error:
        raise RecordingError(f"cannot write {output}: {error.strerror or error}") from None
    except KeyboardInterrupt:
        kept = resumable
        raise
    finally:
        if not kept:
            remove(partial)
    return count


def open_sink(path: Path, named: Path, source: Source, color: bool) -> FrameSink:
    """A sink at ``path`` of the kind that ``named`` asks for."""
    camera: Camera = source.info.camera
    if named.suffix.lower() == ".mcap":
        config = RecordingConfig(color=color)
        return McapWriter(path, camera, source_uri=source.info.uri, color=source.info.has_color, config=config)
    if named.suffix.lower() == ".fakenect":
        return FakenectWriter(path, camera)
    return RgbdFolderWriter(path, camera)


def refuse_overwrite(output: Path, source: Source, force: bool) -> None:
    """Raises RecordingError when the output exists and may not be replaced, or is the source itself."""
    if not output.parent.is_dir():
        raise RecordingError(f"no folder {output.parent} to write {output.name} into; create it first")
    if not output.exists() or (output.is_dir() and not any(output.iterdir())):
        return
    if Path(source.info.uri).exists() and output.resolve() == Path(source.info.uri).resolve():
        raise RecordingError(f"{output} is the source itself; choose another name")
    if not force:
        raise RecordingError(f"{output} exists already; add --force to replace it")
    if output.suffix.lower() in _FILES:
        if output.is_dir():
            raise RecordingError(f"{output} is a folder; choose another name")
        return
    ours = _is_dataset if output.suffix.lower() == ".lerobot" else _is_ours
    foreign = [p.name for p in output.iterdir() if not ours(p)] if output.is_dir() else [output.name]
    if foreign:
        raise RecordingError(f"{output} holds more than images of a session ({foreign[0]}); it is not replaced")


def _is_ours(path: Path) -> bool:
    return path.name in _FOLDER_CONTENT or (path.name[:2] in ("d-", "r-") and path.suffix in (".pgm", ".ppm"))


def _is_dataset(path: Path) -> bool:
    return path.name in _DATASET_CONTENT


def _copy(
    source: Source,
    sink: FrameSink | ResumableSink,
    color: bool,
    from_s: float,
    seconds: float | None,
    on_frame: Callable[[DepthFrame], None] | None,
) -> int:
    count, done = 0, getattr(sink, "frames_done", 0)
    first_ns: int | None = None
    try:
        for frame in source.frames(from_s):
            first_ns = frame.t_ns if first_ns is None else first_ns
            if seconds is not None and frame.t_ns - first_ns > seconds * 1e9:
                break
            kept = frame if color else frame.without_color()
            if count < done:
                sink.skip(kept)  # type: ignore[union-attr]  # only such a sink has frames already
            else:
                sink.write_frame(kept)
            count += 1
            if on_frame is not None:
                on_frame(frame)
    finally:
        sink.close()
    return count
