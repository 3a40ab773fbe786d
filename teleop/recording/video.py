"""A recording as a film: the depth image in colours with the skeleton over it, the colour image beside it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from teleop.errors import RecordingError
from teleop.frames import Camera, DepthFrame, pixels
from teleop.joints import BONES, JOINT_NAMES

NEAR_MM, FAR_MM = 800, 4500
"""Depth drawn in the first and the last colour; as the console's defaults."""
_BONE, _JOINT, _TEXT = (255, 255, 255), (60, 60, 255), (255, 255, 255)
_TEXT_ROWS = 48
_LONGEST_GAP_S = 2.0

Picture = npt.NDArray[np.uint8]


def overlay(frame: DepthFrame, row: Mapping[str, Any], height: int = 480) -> Picture:
    """(height, w, 3) uint8 BGR of one frame and its tracking row; depth, and colour to its right if there is any."""
    scale = height / frame.depth_mm.shape[0]
    picture = _resized(_depth_colors(frame), height)
    _draw_skeleton(picture, row, frame.camera, scale)
    words = f"{row['t']:.2f} s  {row['zone']}  {row['mode']}"
    lines = (words, " ".join(row["reasons"]))
    picture[:_TEXT_ROWS] //= 3
    for number, text in enumerate(lines):
        place = (8, 20 + 20 * number)
        cv2.putText(picture, text, place, cv2.FONT_HERSHEY_SIMPLEX, 0.5, _TEXT, 1, cv2.LINE_AA)
    if frame.color_rgb is None:
        return picture
    color = _resized(frame.color_rgb[:, :, ::-1], height)
    return np.ascontiguousarray(np.hstack([picture, color]))


class VideoWriter:
    """An MP4 at a constant rate that keeps the frames' own times: frames are repeated or left out."""

    def __init__(self, path: Path, rate_hz: float) -> None:
        """path: NAME.mp4. Raises RecordingError for a rate that is none."""
        if not 1.0 <= rate_hz <= 120.0:
            raise RecordingError(f"a film has 1 to 120 pictures a second, not {rate_hz:g}")
        self._path = path
        self._rate_hz = rate_hz
        self._video: cv2.VideoWriter | None = None
        self._size = (0, 0)
        self._shown: Picture | None = None
        self._first_ns: int | None = None
        self._written = 0

    def write(self, t_ns: int, picture: Picture) -> None:
        """Show the picture from ``t_ns`` on and the one before until then; a gap is cut to two seconds.

        Raises RecordingError.
        """
        if self._video is None:
            self._open(picture)
        if (picture.shape[1], picture.shape[0]) != self._size:
            picture = cv2.resize(picture, self._size).astype(np.uint8, copy=False)
        if self._first_ns is None:
            self._first_ns = t_ns
        due = round((t_ns - self._first_ns) * 1e-9 * self._rate_hz) + 1 - self._written
        longest = round(_LONGEST_GAP_S * self._rate_hz)
        if due > longest:
            self._first_ns += round((due - longest) / self._rate_hz * 1e9)
            due = longest
        assert self._video is not None
        for left in range(due, 0, -1):
            self._video.write(self._shown if left > 1 and self._shown is not None else picture)
        self._shown = picture
        self._written += max(0, due)

    def close(self) -> None:
        """Finish the file; safe to call twice."""
        if self._video is not None:
            self._video.release()
            self._video = None

    def _open(self, picture: Picture) -> None:
        self._size = (picture.shape[1], picture.shape[0])
        code = cv2.VideoWriter.fourcc(*"mp4v")
        self._video = cv2.VideoWriter(str(self._path), code, self._rate_hz, self._size)
        if not self._video.isOpened():
            self._video = None
            raise RecordingError(f"cannot write {self._path}: OpenCV here has no MPEG-4 encoder, or the disk is full")


def _depth_colors(frame: DepthFrame) -> Picture:
    depth = frame.depth_mm
    level = np.clip((FAR_MM - depth.astype(np.float32)) * (255.0 / (FAR_MM - NEAR_MM)), 0, 255).astype(np.uint8)
    colors = cv2.applyColorMap(level, cv2.COLORMAP_TURBO)
    colors[depth == 0] = 0
    return colors.astype(np.uint8, copy=False)


def _resized(image: npt.NDArray[np.uint8], height: int) -> Picture:
    # MPEG-4 wants even sizes
    width = 2 * round(image.shape[1] * height / image.shape[0] / 2)
    resized = cv2.resize(np.ascontiguousarray(image), (width, height), interpolation=cv2.INTER_LINEAR)
    return resized.astype(np.uint8, copy=False)


def _draw_skeleton(picture: Picture, row: Mapping[str, Any], camera: Camera, scale: float) -> None:
    points: dict[int, tuple[int, int]] = {}
    for number, name in enumerate(JOINT_NAMES):
        position = row["joints"].get(name)
        if position is None or position[2] <= 0:
            continue
        u, v = pixels(np.array(position), camera) * scale
        if abs(u) < 10_000 and abs(v) < 10_000:
            points[number] = (round(float(u)), round(float(v)))
    for a, b in BONES:
        if a in points and b in points:
            cv2.line(picture, points[a], points[b], _BONE, 2, cv2.LINE_AA)
    for point in points.values():
        cv2.circle(picture, point, 4, _JOINT, -1, cv2.LINE_AA)
