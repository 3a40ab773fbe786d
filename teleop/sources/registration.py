"""Colour laid over depth, for sensors whose library does not do it: each depth pixel takes the colour it is seen in.

The point of a depth pixel is moved into the colour camera and projected there (pinhole, both in optical axes: x right
in the image, y down, z forward). What a nearer point hides from the colour camera stays black, as does no reading.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from teleop.frames import Camera, ColorImage, DepthImage

HIDDEN_M = 0.05
"""A point this far behind the nearest one on its colour pixel is hidden: ten times the noise at 2 m."""


class Registration:
    """For one camera that has a colour camera of its own."""

    def __init__(self, camera: Camera) -> None:
        """camera: with ``color``, perhaps with ``T_color_depth``."""
        if camera.color is None:
            raise ValueError("the colour of this camera is registered already")
        self._color = camera.color
        k = camera.depth
        u, v = np.meshgrid(np.arange(k.width), np.arange(k.height))
        rays = np.stack([(u - k.cx) / k.fx, (v - k.cy) / k.fy, np.ones(u.shape)], axis=-1)
        T_color_depth = np.eye(4) if camera.T_color_depth is None else np.array(camera.T_color_depth)
        self._rays = (rays @ T_color_depth[:3, :3].T).astype(np.float32)
        self._move_m = T_color_depth[:3, 3].astype(np.float32)
        self.camera = Camera(k, camera.mirrored)
        """What the frames are from then on."""

    def __call__(self, depth_mm: DepthImage, color_rgb: ColorImage) -> ColorImage:
        """depth (H, W) and colour (h, w, 3) to colour (H, W, 3) as the depth camera sees it."""
        height, width = color_rgb.shape[:2]
        k = self._color.scaled(width, height)
        rows, columns = np.nonzero(depth_mm)
        z_m = depth_mm[rows, columns].astype(np.float32) * 1e-3
        points = self._rays[rows, columns] * z_m[:, None] + self._move_m
        seen = points[:, 2] > 0
        rows, columns, points = rows[seen], columns[seen], points[seen]
        u = np.rint(points[:, 0] / points[:, 2] * k.fx + k.cx)
        v = np.rint(points[:, 1] / points[:, 2] * k.fy + k.cy)
        inside = (u >= 0) & (u < width) & (v >= 0) & (v < height)
        pixel = v[inside].astype(np.intp) * width + u[inside].astype(np.intp)
        z = points[inside, 2]
        nearest: npt.NDArray[np.float32] = np.full(width * height, np.inf, dtype=np.float32)
        np.minimum.at(nearest, pixel, z)
        visible = z <= nearest[pixel] + HIDDEN_M
        out = np.zeros((*depth_mm.shape, 3), dtype=np.uint8)
        out[rows[inside][visible], columns[inside][visible]] = color_rgb.reshape(-1, 3)[pixel[visible]]
        return out
