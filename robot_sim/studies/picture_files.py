"""Pictures in sequence as PNG files or one MP4 video."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from robot_sim.errors import RobotError

Image = npt.NDArray[np.uint8]


def write_frames(images: Iterator[Image], folder: Path, tick: Callable[[], None]) -> int:
    """Write pictures as frame_00000.png and on into a folder that is made; returns how many."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RobotError(f"cannot make the folder {folder}: {error.strerror}; choose another one") from None
    count = 0
    for count, rgb in enumerate(images, start=1):
        if not cv2.imwrite(str(folder / f"frame_{count - 1:05d}.png"), rgb[:, :, ::-1]):
            raise RobotError(f"cannot write pictures into {folder}; choose another folder")
        tick()
    return count


def write_video(images: Iterator[Image], path: Path, fps: float, tick: Callable[[], None]) -> int:
    """Write pictures as one MP4 file; returns how many."""
    count, out = 0, None
    if not path.parent.is_dir():
        raise RobotError(f"there is no folder {path.parent}; make it or choose another file")
    for rgb in images:
        if out is None:
            height, width = rgb.shape[:2]
            out = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), fps, (width, height))
            if not out.isOpened():
                raise RobotError(f"cannot write {path}; choose a file ending in .mp4 in a folder you may write")
        out.write(np.ascontiguousarray(rgb[:, :, ::-1]))
        count += 1
        tick()
    if out is not None:
        out.release()
    return count
