"""``teleop study play``: a study's motion in PyBullet's window, as a video or as pictures."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from robot_sim.errors import RobotError


def play(
    file: Annotated[Path, typer.Argument(help="The motion.mcap of a study.", metavar="FILE")],
    gui: Annotated[bool, typer.Option("--gui", help="Play in PyBullet's window; needs a display.")] = False,
    video: Annotated[Path | None, typer.Option(help="Draw into this MP4 file.", metavar="OUT.mp4")] = None,
    frames: Annotated[Path | None, typer.Option(help="Draw PNG pictures into this folder.", metavar="DIR")] = None,
    fps: Annotated[float, typer.Option(min=0.1, max=120, help="Pictures a second of video or pictures.")] = 25.0,
    speed: Annotated[float, typer.Option(min=0.05, max=50, help="Speed of the window.")] = 1.0,
) -> None:
    """Play a study's motion in PyBullet, path and volumes drawn.

    Without an option: in PyBullet's window where there is a display, else as an MP4 beside FILE.
    """
    if gui + (video is not None) + (frames is not None) > 1:
        raise typer.BadParameter("choose one of --gui, --video and --frames")
    from robot_sim.studies.motion_read import read_motion
    from robot_sim.studies.player import frame_times, pictures, play_in_window

    motion = read_motion(file)
    if gui or (video is None and frames is None and _has_display()):
        if not _has_display():
            raise RobotError("there is no display for PyBullet's window; play with --video FILE or --frames FOLDER")
        play_in_window(motion, speed)
        return
    from robot_sim.studies.picture_files import write_frames, write_video

    with _bar(len(frame_times(motion, fps))) as tick:
        if frames is not None:
            count, where = write_frames(pictures(motion, fps), frames, tick), frames
        else:
            where = video or file.with_suffix(".mp4")
            count = write_video(pictures(motion, fps), where, fps, tick)
    typer.echo(f"{where}  {count} pictures, {motion.duration_s:.1f} s")


def _has_display() -> bool:
    return sys.platform in ("win32", "darwin") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


@contextmanager
def _bar(total: int) -> Iterator[Callable[[], None]]:
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("drawing", total=total)
        yield lambda: bar.advance(task)
