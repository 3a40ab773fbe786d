"""camera.json of an RGB-D folder: intrinsics, depth scale, mirrored or not, perhaps a second camera for colour."""

from __future__ import annotations

import json
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from teleop.errors import SourceError
from teleop.frames import Camera, Intrinsics


class IntrinsicsFile(BaseModel):
    """A pinhole camera in pixels."""

    model_config = ConfigDict(frozen=True, extra="ignore", allow_inf_nan=False)

    fx: float = Field(gt=0)
    fy: float = Field(gt=0)
    cx: float
    cy: float
    width: int = Field(gt=0, le=16384)
    height: int = Field(gt=0, le=16384)

    def intrinsics(self) -> Intrinsics:
        """As the type of the data flow."""
        return Intrinsics(self.fx, self.fy, self.cx, self.cy, self.width, self.height)


_Row = tuple[float, float, float, float]


class ColorFile(IntrinsicsFile):
    """The colour camera and its pose: colour-camera point = T_color_depth @ depth-camera point, metres."""

    T_color_depth: tuple[_Row, _Row, _Row, _Row] | None = None


class CameraFile(IntrinsicsFile):
    """The whole file. depth_scale: depth units per metre (1000: millimetres, 5000: the TUM benchmark's)."""

    depth_scale: float = Field(default=5000.0, gt=0)
    mirrored: bool = False
    color: ColorFile | None = None

    def camera(self) -> Camera:
        """As the type of the data flow."""
        color = self.color
        return Camera(
            self.intrinsics(),
            self.mirrored,
            color.intrinsics() if color else None,
            color.T_color_depth if color else None,
        )


def tum_default(width: int, height: int) -> CameraFile:
    """What the TUM RGB-D benchmark assumes for a Kinect v1: 525 px at 640x480, 5000 units per metre."""
    k = Intrinsics(525.0, 525.0, 319.5, 239.5, 640, 480).scaled(width, height)
    return CameraFile(fx=k.fx, fy=k.fy, cx=k.cx, cy=k.cy, width=width, height=height)


def read_camera_json(path: Path) -> CameraFile:
    """Read and check. Raises SourceError naming the first wrong value."""
    try:
        return CameraFile.model_validate(json.loads(path.read_text(encoding="utf-8")))
    except OSError as error:
        raise SourceError(f"cannot read {path}: {error.strerror or error}") from None
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise SourceError(
            f"{path}: {where or 'content'}: {first['msg']}; it needs fx fy cx cy width height depth_scale"
        ) from None
    except ValueError as error:
        raise SourceError(f"{path} is not JSON: {error}") from None


def write_camera_json(path: Path, camera: Camera, depth_scale: float) -> None:
    """The inverse of ``read_camera_json``."""
    k = camera.depth
    color = None
    if camera.color is not None:
        c = camera.color
        color = ColorFile(
            fx=c.fx, fy=c.fy, cx=c.cx, cy=c.cy, width=c.width, height=c.height, T_color_depth=_rows(camera)
        )
    content = CameraFile(
        fx=k.fx,
        fy=k.fy,
        cx=k.cx,
        cy=k.cy,
        width=k.width,
        height=k.height,
        depth_scale=depth_scale,
        mirrored=camera.mirrored,
        color=color,
    )
    path.write_text(content.model_dump_json(indent=1, exclude_none=True) + "\n", encoding="utf-8")


def _rows(camera: Camera) -> tuple[_Row, _Row, _Row, _Row] | None:
    matrix = camera.T_color_depth
    if matrix is None:
        return None
    a, b, c, d = ((r[0], r[1], r[2], r[3]) for r in matrix)
    return a, b, c, d
