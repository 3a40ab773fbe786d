"""The depth frame and its camera: the first arrow of the data flow.

Axes (skeleton space, metres, right-handed, origin at the depth camera)::

        y up                 operator
        |    z away           (o_o)   x runs towards the operator's right,
        |   /  from          --|--    which is the LEFT of an unmirrored image
        |  /   sensor          |
  x ----+                     / \\

Unmirrored image: x = -(u - cx) z / fx. Mirrored image (as the Kinect gives it): x = +(u - cx) z / fx.
Always y = -(v - cy) z / fy. Pixels: u column, v row.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from teleop.errors import FrameError

DepthImage = npt.NDArray[np.uint16]
ColorImage = npt.NDArray[np.uint8]
_Pixel = TypeVar("_Pixel", np.uint16, np.uint8)


@dataclass(frozen=True, slots=True)
class Intrinsics:
    """Pinhole camera without distortion; lengths in pixels."""

    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int

    def __post_init__(self) -> None:
        if not (self.fx > 0 and self.fy > 0 and np.isfinite([self.fx, self.fy, self.cx, self.cy]).all()):
            raise FrameError(f"camera: fx and fy must be positive and all values finite, got {self}")
        if self.width < 1 or self.height < 1:
            raise FrameError(f"camera: width and height must be positive, got {self.width}x{self.height}")

    def scaled(self, width: int, height: int) -> Intrinsics:
        """The same camera read out at another resolution (pixel centres at integers)."""
        sx, sy = width / self.width, height / self.height
        return Intrinsics(
            self.fx * sx,
            self.fy * sy,
            (self.cx + 0.5) * sx - 0.5,
            (self.cy + 0.5) * sy - 0.5,
            width,
            height,
        )


def kinect_v1(width: int = 640, height: int = 480) -> Intrinsics:
    """Kinect v1 depth camera with its customary focal length (571.26 px at 640x480)."""
    return Intrinsics(571.26, 571.26, 320.0, 240.0, 640, 480).scaled(width, height)


@dataclass(frozen=True, slots=True)
class Camera:
    """A depth camera, perhaps with a colour camera beside it.

    mirrored: the image shows the operator as a mirror does.
    color: the colour camera's own intrinsics; None when colour is registered to depth pixel by pixel.
    T_color_depth: 4x4, metres, colour-camera point = T @ depth-camera point, both in optical axes
        (x right, y down, z forward); None is the identity.
    """

    depth: Intrinsics = field(default_factory=kinect_v1)
    mirrored: bool = False
    color: Intrinsics | None = None
    T_color_depth: tuple[tuple[float, ...], ...] | None = None

    @property
    def x_sign(self) -> float:
        """Sign of x for a pixel right of the image centre."""
        return 1.0 if self.mirrored else -1.0


@dataclass(frozen=True, slots=True, eq=False)
class DepthFrame:
    """One image pair. Arrays are read-only for everybody downstream.

    t_ns: the source's own time stamp. depth_mm: (H, W) uint16, 0 = no reading.
    color_rgb: (h, w, 3) uint8 RGB or None. seq: running number given by the source.
    color_jpeg: the JPEG that color_rgb was decoded from, if it was; a recording keeps it as it is.
    """

    t_ns: int
    depth_mm: DepthImage
    camera: Camera
    color_rgb: ColorImage | None = None
    seq: int = 0
    color_jpeg: bytes | None = None

    def __post_init__(self) -> None:
        d = self.depth_mm
        if d.dtype != np.uint16 or d.ndim != 2:
            raise FrameError(
                f"depth must be a 2-D 16-bit image in millimetres, got {d.dtype} with shape {d.shape}; "
                "convert 8-bit or colour-coded depth before reading it"
            )
        if d.shape != (self.camera.depth.height, self.camera.depth.width):
            raise FrameError(
                f"depth image is {d.shape[1]}x{d.shape[0]} but the camera says "
                f"{self.camera.depth.width}x{self.camera.depth.height}; correct camera.json or camera_info"
            )
        c = self.color_rgb
        if c is not None and (c.dtype != np.uint8 or c.ndim != 3 or c.shape[2] != 3):
            raise FrameError(f"colour must be an 8-bit RGB image, got {c.dtype} with shape {c.shape}")
        # one layout whatever the source: compiled kernels are compiled once, before the first frame
        object.__setattr__(self, "depth_mm", _read_only(d))
        if c is not None:
            object.__setattr__(self, "color_rgb", _read_only(c))

    @property
    def t_s(self) -> float:
        """The time stamp in seconds."""
        return self.t_ns / 1e9

    def without_color(self) -> DepthFrame:
        """The same frame with the colour dropped (privacy)."""
        return replace(self, color_rgb=None, color_jpeg=None)


def _read_only(image: npt.NDArray[_Pixel]) -> npt.NDArray[_Pixel]:
    """The image, rows without gaps, as a view that cannot be written."""
    view = np.ascontiguousarray(image).view()
    view.setflags(write=False)
    return view


def points_m(u: npt.ArrayLike, v: npt.ArrayLike, depth_m: npt.ArrayLike, camera: Camera) -> npt.NDArray[np.float64]:
    """Reproject pixels to skeleton space: arrays (N,) of column, row and depth give (N, 3) metres."""
    k = camera.depth
    z = np.asarray(depth_m, dtype=np.float64)
    x = camera.x_sign * (np.asarray(u, dtype=np.float64) - k.cx) * z / k.fx
    y = -(np.asarray(v, dtype=np.float64) - k.cy) * z / k.fy
    return np.stack([x, y, z], axis=-1)


def pixels(points: npt.ArrayLike, camera: Camera) -> npt.NDArray[np.float64]:
    """Project skeleton-space points (..., 3) in metres to depth pixels (..., 2) as (u, v)."""
    p = np.asarray(points, dtype=np.float64)
    k = camera.depth
    u = k.cx + camera.x_sign * k.fx * p[..., 0] / p[..., 2]
    v = k.cy - k.fy * p[..., 1] / p[..., 2]
    return np.stack([u, v], axis=-1)
