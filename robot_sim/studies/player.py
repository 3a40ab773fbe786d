"""Plays a study's motion in PyBullet: in its window, or drawn without a display, path and volumes with it.

PyBullet's software renderer knows no transparency and no debug lines, and is slow with many shapes. So the standing
things are drawn once, and each picture puts the arm before or behind them by depth; the path is thin sticks.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pybullet

from robot_sim.errors import RobotError
from robot_sim.kinematics.transforms import FloatArray
from robot_sim.primitives import Primitive, Rgba, Vec3, rod, rotation
from robot_sim.studies.motion_read import StoredMotion

Image = npt.NDArray[np.uint8]
STICK_SHARE = 0.003
"""Thickness of the path's sticks over the size of what is seen."""
FIELD_DEG = 38.0
NEAR_M, FAR_M, OUT_OF_SIGHT_M = 0.05, 20.0, 1000.0
SKY = np.array([236, 241, 238], dtype=np.uint8)


@dataclass(frozen=True, slots=True)
class Eye:
    """Where the camera stands and looks at, m."""

    eye_m: Vec3
    target_m: Vec3


@dataclass(frozen=True, slots=True, eq=False)
class _Layer:
    rgb: Image
    depth: npt.NDArray[np.float32]


class MotionScene:
    """The robot of a motion in a physics client of its own. Use as a context manager or close it."""

    def __init__(self, motion: StoredMotion, window: bool = False) -> None:
        """Load robot, volumes and path. Raises RobotError when PyBullet gives no client or refuses the URDF."""
        self.motion = motion
        self._client = pybullet.connect(pybullet.GUI if window else pybullet.DIRECT)
        if self._client < 0:
            raise RobotError("PyBullet cannot open its window here; play with --video FILE or --frames FOLDER")
        try:
            self._robot = self._load(motion)
        except pybullet.error as error:
            self.close()
            raise RobotError(f"PyBullet cannot load the motion's robot: {error}") from None
        names = [
            pybullet.getJointInfo(self._robot, i, physicsClientId=self._client)[1].decode()
            for i in range(pybullet.getNumJoints(self._robot, physicsClientId=self._client))
        ]
        self._joints = {name: i for i, name in enumerate(names)}
        path = _sticks(motion.path_m, motion.path_rgba)
        volumes = motion.volumes
        self._solid = [self._add(p) for p in (*(v for v in volumes if v.rgba[3] >= 1.0), *path)]
        glass = [v for v in volumes if v.rgba[3] < 1.0]
        self._glass = [self._add(v) for v in glass]
        self._alpha = min((v.rgba[3] for v in glass), default=1.0)
        self._home = {
            body: pybullet.getBasePositionAndOrientation(body, physicsClientId=self._client)
            for body in (self._robot, *self._solid, *self._glass)
        }

    def __enter__(self) -> MotionScene:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Give the physics client back; safe to call twice."""
        if self._client >= 0 and pybullet.isConnected(self._client):
            pybullet.disconnect(self._client)
        self._client = -1

    @property
    def open(self) -> bool:
        """False once the window was closed."""
        return self._client >= 0 and bool(pybullet.isConnected(self._client))

    def _load(self, motion: StoredMotion) -> int:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "robot.urdf"
            file.write_text(motion.urdf, encoding="utf-8")
            return int(
                pybullet.loadURDF(
                    str(file),
                    basePosition=motion.base_xyz_m,
                    baseOrientation=pybullet.getQuaternionFromEuler(motion.base_rpy_rad),
                    useFixedBase=True,
                    physicsClientId=self._client,
                )
            )

    def _add(self, p: Primitive) -> int:
        c = self._client
        rgba = list(p.rgba)
        if p.kind == "box":
            half = [s / 2 for s in p.size_m]
            shape = pybullet.createVisualShape(pybullet.GEOM_BOX, halfExtents=half, rgbaColor=rgba, physicsClientId=c)
        elif p.kind == "cylinder":
            radius, length = p.size_m
            shape = pybullet.createVisualShape(
                pybullet.GEOM_CYLINDER, radius=radius, length=length, rgbaColor=rgba, physicsClientId=c
            )
        else:
            radius = p.size_m[0]
            shape = pybullet.createVisualShape(pybullet.GEOM_SPHERE, radius=radius, rgbaColor=rgba, physicsClientId=c)
        turn = pybullet.getQuaternionFromEuler(p.rpy_rad)
        return int(
            pybullet.createMultiBody(
                baseMass=0.0,
                baseVisualShapeIndex=shape,
                basePosition=p.xyz_m,
                baseOrientation=turn,
                physicsClientId=c,
            )
        )

    def place(self, t_s: float) -> None:
        """Put the robot where it is at a time. Joints that its URDF does not have are left out."""
        for name, value in self.motion.at(t_s).items():
            if name in self._joints:
                pybullet.resetJointState(self._robot, self._joints[name], value, physicsClientId=self._client)

    def link_points(self) -> FloatArray:
        """Where the links are now (L, 3), base included."""
        links = [
            pybullet.getLinkState(self._robot, i, 1, 1, physicsClientId=self._client)[4] for i in self._joints.values()
        ]
        return np.array([self.motion.base_xyz_m, *links], dtype=np.float64)

    def show(self, bodies: str) -> None:
        """Move everything but "robot", "solid" or "glass" out of sight; "all" brings everything back."""
        groups = {"robot": [self._robot], "solid": self._solid, "glass": self._glass}
        for name, members in groups.items():
            for body in members:
                (x, y, z), turn = self._home[body]
                place = (x, y, z if bodies in (name, "all") else z + OUT_OF_SIGHT_M)
                pybullet.resetBasePositionAndOrientation(body, place, turn, physicsClientId=self._client)

    def layer(self, eye: Eye, size: tuple[int, int]) -> _Layer:
        """What is in sight, with depth in PyBullet's own buffer units (1: nothing)."""
        view = pybullet.computeViewMatrix(eye.eye_m, eye.target_m, (0, 0, 1))
        lens = pybullet.computeProjectionMatrixFOV(FIELD_DEG, size[0] / size[1], NEAR_M, FAR_M)
        width, height, rgba, depth, _ = pybullet.getCameraImage(
            size[0],
            size[1],
            view,
            lens,
            shadow=0,
            lightDirection=(1.0, -1.5, 2.5),
            renderer=pybullet.ER_TINY_RENDERER,
            physicsClientId=self._client,
        )
        rgb = np.asarray(rgba, dtype=np.uint8).reshape(height, width, 4)[:, :, :3]
        return _Layer(rgb, np.asarray(depth, dtype=np.float32).reshape(height, width))

    def frame_view(self) -> Eye:
        """A camera that sees the whole motion from ahead and aside."""
        seen = []
        for t in np.linspace(0.0, self.motion.duration_s, 25):
            self.place(float(t))
            seen.append(self.link_points())
        points = np.concatenate([*seen, self.motion.path_m, *(_ends(v) for v in self.motion.volumes)])
        low, high = points.min(axis=0), points.max(axis=0)
        middle = (low + high) / 2
        radius = 0.5 * float(np.linalg.norm(high - low))
        away = 0.9 * radius / np.sin(np.radians(FIELD_DEG / 2))
        at = middle + away * np.array([0.62, -0.62, 0.48])
        return Eye((at[0], at[1], at[2]), (middle[0], middle[1], middle[2]))

    @property
    def glass_alpha(self) -> float:
        """Opacity with which the see-through volumes are laid over."""
        return self._alpha


def _ends(p: Primitive) -> FloatArray:
    """Two points (2, 3) at the ends of a volume's own z axis."""
    half = p.size_m[-1] / (1 if p.kind == "sphere" else 2)
    axis = rotation(p.rpy_rad)[:, 2] * half
    return np.array([p.xyz_m - axis, p.xyz_m + axis])


def _sticks(path_m: FloatArray, rgba: Rgba) -> list[Primitive]:
    """The path as rods longer than they are thick."""
    if len(path_m) == 0:
        return []
    thick = STICK_SHARE * max(0.3, float(np.linalg.norm(np.ptp(path_m, axis=0))))
    kept: list[FloatArray] = []
    for p in path_m:
        if not kept or np.linalg.norm(p - kept[-1]) > 3 * thick:
            kept.append(p)
    ends = [(float(x), float(y), float(z)) for x, y, z in kept]
    return [rod("", a, b, thick / 2, rgba) for a, b in pairwise(ends)]


def pictures(motion: StoredMotion, fps: float, size: tuple[int, int] = (960, 720)) -> Iterator[Image]:
    """RGB pictures (H, W, 3) of the whole motion at its own pace, drawn without a display."""
    with MotionScene(motion) as scene:
        eye = scene.frame_view()
        scene.show("solid")
        solid = scene.layer(eye, size)
        scene.show("glass")
        glass = scene.layer(eye, size)
        scene.show("robot")
        for t in frame_times(motion, fps):
            scene.place(float(t))
            yield _laid(scene.layer(eye, size), solid, glass, scene.glass_alpha)


def frame_times(motion: StoredMotion, fps: float) -> FloatArray:
    """Times of the pictures, the end included. Raises RobotError for a rate that is not positive."""
    if not fps > 0:
        raise RobotError(f"pictures a second must be positive, not {fps}")
    return np.append(np.arange(0.0, motion.duration_s, 1.0 / fps), motion.duration_s)


def _laid(robot: _Layer, solid: _Layer, glass: _Layer, alpha: float) -> Image:
    nearer = robot.depth < solid.depth
    out = np.where(nearer[:, :, None], robot.rgb, solid.rgb)
    depth = np.minimum(robot.depth, solid.depth)
    out[depth >= 1.0] = SKY
    over = glass.depth < depth
    out[over] = (alpha * glass.rgb[over] + (1 - alpha) * out[over]).astype(np.uint8)
    return out


def play_in_window(motion: StoredMotion, speed: float = 1.0, times: int = 1) -> None:
    """Open PyBullet's window and play at a speed, so many times; returns when it is done or the window is closed."""
    with MotionScene(motion, window=True) as scene:
        eye = scene.frame_view()
        reach = np.subtract(eye.eye_m, eye.target_m)
        distance = float(np.linalg.norm(reach))
        pybullet.resetDebugVisualizerCamera(distance, 45.0, -28.0, eye.target_m)
        for _ in range(times):
            began = time.monotonic()
            while scene.open and (now := (time.monotonic() - began) * speed) <= motion.duration_s:
                scene.place(now)
                time.sleep(1 / 60)
