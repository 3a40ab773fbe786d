"""The one depth-difference sampler, used in training and at run time (Shotton 2011, eq. 1).

``f(x; u, v) = d(x + u/d(x)) - d(x + v/d(x))``, offsets in metres times the focal length in pixels, so that a model
trained at one resolution and focal length serves every other. All images are *canonical*: columns run towards the
operator's right (as a mirror shows it), cropped to the operator, padded so that no feature needs a bounds check.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.frames import Camera

FAR_MM: Final = 10_000
"""What a pixel off the operator reads, the published "large constant"."""


PixelTuple = tuple[npt.NDArray[np.int16], int, int, int, npt.NDArray[np.float64]]
"""Pixels as compiled code takes them, its fields in order."""


@dataclass(frozen=True, slots=True, eq=False)
class Pixels:
    """The operator's canonical image inside an array of one or many: flat_mm row by row, index of its first pixel,
    width, height, intrinsics fx, fy, cx, cy (4,) counted from its first pixel."""

    flat_mm: npt.NDArray[np.int16]
    first: int
    width: int
    height: int
    intrinsics: npt.NDArray[np.float64]

    def tuple(self) -> PixelTuple:
        """For compiled code."""
        return self.flat_mm, self.first, self.width, self.height, self.intrinsics


@dataclass(frozen=True, slots=True, eq=False)
class PaddedImage:
    """A canonical depth image of the operator alone.

    depth_mm: (h, w) int16, FAR_MM off the operator. u0, v0: canonical image coordinates of element (0, 0), may be
    negative. fx, fy, cx, cy: canonical intrinsics: x = (u - cx) z / fx, y = -(v - cy) z / fy.
    """

    depth_mm: npt.NDArray[np.int16]
    u0: int
    v0: int
    fx: float
    fy: float
    cx: float
    cy: float


@nb.njit(cache=True, nogil=True)
def _cut_row(
    depths: npt.NDArray[np.uint16], inside: npt.NDArray[np.bool_], step: int, row: npt.NDArray[np.int16]
) -> int:
    """Every step-th pixel, FAR_MM off the operator; the nearest depth."""
    far, nearest, apart = np.int16(FAR_MM), np.int16(FAR_MM), np.uint64(step)
    # unsigned indices cannot be negative, so the loops are done in steps of many pixels
    for j in range(np.uint64(len(row))):
        z, own = depths[j * apart], inside[j * apart]
        value = np.int16(z) if own & (z < FAR_MM) else far
        row[j] = value
        nearest = min(nearest, value)
    return int(nearest)


@nb.njit(cache=True, nogil=True)
def _cut(
    depth_mm: npt.NDArray[np.uint16], mask: npt.NDArray[np.bool_], box: tuple[int, int, int, int], step: int, flip: bool
) -> tuple[npt.NDArray[np.int16], int]:
    """Every step-th pixel of the box, FAR_MM off the operator, and the nearest depth; flip: columns backwards."""
    u0, v0, u1, v1 = box
    height, width = max(0, -((v0 - v1) // step)), max(0, -((u0 - u1) // step))
    out, line, nearest = np.empty((height, width), np.int16), np.empty(width, np.int16), FAR_MM
    for i in range(height):
        depths, inside, row = depth_mm[v0 + i * step, u0:u1], mask[v0 + i * step, u0:u1], out[i]
        if flip:
            nearest = min(nearest, _cut_row(depths, inside, step, line))
            for j in range(np.uint64(width)):
                row[j] = line[np.uint64(width - 1) - j]
        else:
            nearest = min(nearest, _cut_row(depths, inside, step, row))
    return out, nearest


def pad_image(
    depth_mm: npt.NDArray[np.uint16],
    mask: npt.NDArray[np.bool_],
    box: tuple[int, int, int, int],
    camera: Camera,
    max_offset_m: float,
    step: int,
) -> PaddedImage:
    """Canonical, cropped and padded image of the operator's pixels, every ``step``-th of them.

    depth_mm, mask: (H, W) in the camera's own orientation. box: (u0, v0, u1, v1) round the mask, ends excluded.
    max_offset_m: the largest feature offset the padding must hold. step: see working_step().
    """
    u0, v0, u1, v1 = box
    u0, v0 = u0 + -u0 % step, v0 + -v0 % step
    k = camera.depth
    fx, fy, cx, cy = k.fx / step, k.fy / step, k.cx / step, k.cy / step
    body, nearest_mm = _cut(depth_mm, mask, (u0, v0, u1, v1), step, not camera.mirrored)
    height, width = body.shape
    pad = int(np.ceil(max_offset_m * max(fx, fy) * 1000.0 / max(nearest_mm, 1))) + 1
    image = np.full((height + 2 * pad, width + 2 * pad), FAR_MM, np.int16)
    left = u0 // step
    if not camera.mirrored:
        # pixel u of the camera is pixel -u here: the canonical image may begin anywhere
        cx, left = -cx, -(left + width - 1)
    image[pad : pad + height, pad : pad + width] = body
    return PaddedImage(image, left - pad, v0 // step - pad, fx, fy, cx, cy)


def operator_pixels(
    depth_mm: npt.NDArray[np.uint16], mask: npt.NDArray[np.bool_], box: tuple[int, int, int, int], camera: Camera
) -> Pixels:
    """Canonical image of the operator's pixels at full resolution, without padding; arguments as in pad_image."""
    body, _ = _cut(depth_mm, mask, box, 1, not camera.mirrored)
    k, (u0, v0, _, _) = camera.depth, box
    height, width = body.shape
    cx = k.cx - u0 if camera.mirrored else width - 1 - (k.cx - u0)
    return Pixels(body.reshape(-1), 0, width, height, np.array([k.fx, k.fy, cx, k.cy - v0]))


def working_step(camera: Camera, working_focal_px: float) -> int:
    """Pixel step that brings the camera nearest to the working focal length: 2 for a Kinect's 640x480."""
    return max(1, round(camera.depth.fx / working_focal_px))


@nb.njit(cache=True, nogil=True, inline="always")
def depth_difference(
    flat_mm: npt.NDArray[np.int16],
    at: int,
    width: int,
    scale_x: float,
    scale_y: float,
    offsets: npt.NDArray[np.int16],
    node: int,
) -> int:
    """Feature of one pixel in mm.

    flat_mm: padded image(s) laid out row by row. at: index of the pixel in it. width: of its image. offsets[node]:
    u_x, u_y, v_x, v_y in 0.1 mm. scale: pixels per 0.1 mm at the pixel; a negative scale_x samples the mirrored
    image exactly, since truncation towards zero is symmetric.
    """
    a = flat_mm[at + int(offsets[node, 1] * scale_y) * width + int(offsets[node, 0] * scale_x)]
    b = flat_mm[at + int(offsets[node, 3] * scale_y) * width + int(offsets[node, 2] * scale_x)]
    return int(a) - int(b)


@nb.njit(cache=True, nogil=True)
def body_pixels(depth_mm: npt.NDArray[np.int16], stride: int) -> npt.NDArray[np.int32]:
    """Rows and columns (N, 2) of every stride-th operator pixel in both directions."""
    height, width = depth_mm.shape
    out = np.empty((((height + stride - 1) // stride) * ((width + stride - 1) // stride), 2), np.int32)
    n = 0
    for row in range(0, height, stride):
        for column in range(0, width, stride):
            if depth_mm[row, column] < FAR_MM:
                out[n, 0] = row
                out[n, 1] = column
                n += 1
    return out[:n].copy()


def body_points(image: PaddedImage, where: npt.NDArray[np.int32]) -> npt.NDArray[np.float32]:
    """Skeleton-space points (N, 3) in metres of pixels given as rows and columns (N, 2)."""
    z = image.depth_mm[where[:, 0], where[:, 1]] * np.float32(1e-3)
    x = (where[:, 1] + np.float32(image.u0 - image.cx)) * z / np.float32(image.fx)
    y = -(where[:, 0] + np.float32(image.v0 - image.cy)) * z / np.float32(image.fy)
    return np.stack([x, y, z], axis=1).astype(np.float32)
