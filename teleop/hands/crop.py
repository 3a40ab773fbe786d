"""Where the hand lies in the colour image, and the depth that belongs to its pixels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from teleop.frames import Camera, ColorImage, DepthFrame


@dataclass(frozen=True, slots=True)
class Pixel:
    """A projected point: column, row, depth along the axis, and pixels per metre at that depth."""

    u: float
    v: float
    z_m: float
    px_per_m: float


def color_pixel(point_m: npt.NDArray[np.float64], camera: Camera, width: int, height: int) -> Pixel | None:
    """Project a skeleton-space point (3,) into a colour image of the given size; None behind the camera.

    Without intrinsics of its own the colour is registered to the depth, perhaps at another resolution.
    """
    # skeleton axes to optical axes (x right in the image, y down); a mirrored image is a mirrored camera
    p = np.array([camera.x_sign * point_m[0], -point_m[1], point_m[2]])
    k = camera.depth
    if camera.color is not None:
        k = camera.color
        if camera.T_color_depth is not None:
            T_color_depth = np.asarray(camera.T_color_depth, dtype=np.float64)
            p = T_color_depth[:3, :3] @ p + T_color_depth[:3, 3]
    if p[2] <= 0.05:
        return None
    k = k.scaled(width, height)
    return Pixel(k.cx + k.fx * p[0] / p[2], k.cy + k.fy * p[1] / p[2], float(p[2]), k.fx / float(p[2]))


def depth_pixel(point_m: npt.NDArray[np.float64], camera: Camera) -> Pixel | None:
    """Project a skeleton-space point (3,) into the depth image; None behind the camera."""
    k, z = camera.depth, float(point_m[2])
    if z <= 0.05:
        return None
    u = k.cx + camera.x_sign * k.fx * point_m[0] / z
    return Pixel(float(u), float(k.cy - k.fy * point_m[1] / z), z, k.fx / z)


def square(image: npt.NDArray, u: float, v: float, side_px: int) -> npt.NDArray | None:
    """Square crop round a pixel, None when it does not lie wholly inside the image."""
    u0, v0 = round(u - side_px / 2), round(v - side_px / 2)
    if u0 < 0 or v0 < 0 or u0 + side_px > image.shape[1] or v0 + side_px > image.shape[0]:
        return None
    return image[v0 : v0 + side_px, u0 : u0 + side_px]


def color_at_depth(frame: DepthFrame) -> ColorImage | None:
    """The colour image when it is registered to the depth image pixel by pixel and of its size, else None."""
    color = frame.color_rgb
    if color is None or frame.camera.color is not None or color.shape[:2] != frame.depth_mm.shape:
        return None
    return color
