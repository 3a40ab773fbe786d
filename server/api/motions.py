"""The motions of the arm studies, for the console's page /motion.html."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

from fastapi import APIRouter, Depends
from pydantic import BaseModel, Field
from starlette.requests import HTTPConnection

from robot_sim.studies.motion_read import StoredMotion, read_motion
from server.api.problems import documented
from server.errors import Refused
from server.wire import SceneryItem

router = APIRouter(prefix="/motions", tags=["motions"])
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,79}")
"""Letters, digits, dash and underscore: no name leads out of the folder."""


class MotionFile(BaseModel):
    """One motion that 'teleop study' kept."""

    id: str
    size_bytes: int
    modified: float = Field(description="Unix time [s]")


class Motion(BaseModel):
    """A motion with everything needed to draw it. Metres, radians, seconds; world axes."""

    id: str
    robot: str
    urdf: str
    base_xyz_m: tuple[float, float, float]
    base_rpy_rad: tuple[float, float, float]
    joint_names: tuple[str, ...]
    t_s: list[float]
    q: list[list[float]] = Field(description="one row of joint values for each time")
    path: list[tuple[float, float, float]] = Field(description="where the tool goes")
    path_rgba: tuple[float, float, float, float]
    volumes: list[SceneryItem]


def _folder(connection: HTTPConnection) -> Path:
    folder: Path = connection.app.state.studies
    return folder


FolderDep = Annotated[Path, Depends(_folder)]


def _files(folder: Path) -> dict[str, Path]:
    if not folder.is_dir():
        return {}
    return {path.stem: path for path in sorted(folder.glob("*.mcap")) if _NAME.fullmatch(path.stem) and path.is_file()}


@router.get("")
def list_motions(folder: FolderDep) -> list[MotionFile]:
    """By name; empty before the first 'teleop study'."""
    stats = {name: path.stat() for name, path in _files(folder).items()}
    return [MotionFile(id=name, size_bytes=s.st_size, modified=s.st_mtime) for name, s in stats.items()]


@router.get("/{motion_id}", responses=documented(404, 409))
def get_motion(folder: FolderDep, motion_id: str) -> Motion:
    """Joint values in time, tool path and volumes."""
    files = _files(folder)
    if motion_id not in files:
        names = ", ".join(files) or "none; 'teleop study tomato --quick' makes one"
        raise Refused(404, f"no motion '{motion_id[:80]}'; there are: {names}")
    return _described(motion_id, read_motion(files[motion_id]))


def _described(name: str, m: StoredMotion) -> Motion:
    volumes = [
        SceneryItem(name=f"volume {i}", kind=p.kind, size_m=p.size_m, xyz_m=p.xyz_m, rpy_rad=p.rpy_rad, rgba=p.rgba)
        for i, p in enumerate(m.volumes)
    ]
    return Motion(
        id=name,
        robot=m.about.get("robot", ""),
        urdf=m.urdf,
        base_xyz_m=m.base_xyz_m,
        base_rpy_rad=m.base_rpy_rad,
        joint_names=m.joint_names,
        t_s=m.t_s.round(6).tolist(),
        q=m.q.round(6).tolist(),
        path=m.path_m.round(5).tolist(),
        path_rgba=m.path_rgba,
        volumes=volumes,
    )
