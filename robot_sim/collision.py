"""Whole-arm collision check with PyBullet's geometry: an arm's URDF against solids and bunches, no dynamics.

The only module of the arm library that loads pybullet. Each check has its own physics client; close it after use.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
import numpy.typing as npt
import pybullet

from robot_sim.errors import RobotError
from robot_sim.kinematics.transforms import FloatArray, to_quaternion
from robot_sim.planner.shapes import Box, Cylinder, Solid, Sphere

MOST_IN_COMPOUND = 16
"""PyBullet takes this many shapes in one body and drops the rest without a word."""


@dataclass(frozen=True, slots=True)
class Contact:
    """A link of the arm nearer to a body than asked: distance in m, negative when they overlap."""

    link: str
    body: str
    distance_m: float


class CollisionWorld:
    """An arm and named bodies. Distances are PyBullet's between collision shapes."""

    def __init__(self, urdf: str, drawn: bool = False) -> None:
        """Load the arm, its base at the world's origin.

        drawn: bodies show up in ``picture``; meshing them for that takes most of the time of adding one.
        Raises RobotError when PyBullet refuses the URDF.
        """
        self._visual = -1
        self._client = pybullet.connect(pybullet.DIRECT)
        if self._client < 0:
            raise RobotError("PyBullet gave no physics client; close other simulations and try again")
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "arm.urdf"
            path.write_text(urdf, encoding="utf-8")
            try:
                self._arm = pybullet.loadURDF(str(path), useFixedBase=True, physicsClientId=self._client)
            except pybullet.error as error:
                self.close()
                raise RobotError(f"PyBullet cannot load the arm's URDF: {error}") from None
        self._links: dict[int, str] = {-1: "base_link"}
        self._joints: dict[str, int] = {}
        for i in range(pybullet.getNumJoints(self._arm, physicsClientId=self._client)):
            info = pybullet.getJointInfo(self._arm, i, physicsClientId=self._client)
            self._links[i] = info[12].decode()
            self._joints[info[1].decode()] = i
        self._index = {name: i for i, name in self._links.items()}
        self._bodies: dict[str, list[int]] = {}
        if not drawn:
            speck = [1e-4] * 3
            self._visual = pybullet.createVisualShape(
                pybullet.GEOM_BOX, halfExtents=speck, physicsClientId=self._client
            )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Give the physics client back; safe to call twice."""
        if self._client >= 0:
            pybullet.disconnect(self._client)
            self._client = -1

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the bodies added."""
        return tuple(self._bodies)

    def add_solid(self, name: str, solid: Solid) -> None:
        """A box, cylinder or sphere in world axes."""
        c = self._client
        if isinstance(solid, Box):
            shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=solid.half_m, physicsClientId=c)
        elif isinstance(solid, Cylinder):
            shape = pybullet.createCollisionShape(
                pybullet.GEOM_CYLINDER, radius=solid.radius_m, height=solid.height_m, physicsClientId=c
            )
        elif isinstance(solid, Sphere):
            shape = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=solid.radius_m, physicsClientId=c)
        else:
            raise RobotError(f"no collision shape for {type(solid).__name__}; use Box, Cylinder or Sphere")
        self._add(name, shape, solid.T)

    def add_spheres(self, name: str, centres_m: FloatArray, radii_m: FloatArray) -> None:
        """One body of many spheres: centres (N, 3) in the body's frame, which is the world's at first; radii (N,)."""
        for first in range(0, len(radii_m), MOST_IN_COMPOUND):
            part = slice(first, first + MOST_IN_COMPOUND)
            shape = pybullet.createCollisionShapeArray(
                shapeTypes=[pybullet.GEOM_SPHERE] * len(radii_m[part]),
                radii=[float(r) for r in radii_m[part]],
                collisionFramePositions=[[float(v) for v in c] for c in centres_m[part]],
                physicsClientId=self._client,
            )
            self._add(name, shape, np.eye(4), more=first > 0)

    def _add(self, name: str, shape: int, T: FloatArray, more: bool = False) -> None:
        if name in self._bodies and not more:
            raise RobotError(f"a body named '{name}' is there already")
        part = pybullet.createMultiBody(
            baseMass=0.0,
            baseCollisionShapeIndex=shape,
            baseVisualShapeIndex=self._visual,
            basePosition=[float(v) for v in T[:3, 3]],
            baseOrientation=to_quaternion(T),
            physicsClientId=self._client,
        )
        self._bodies.setdefault(name, []).append(part)

    def paint(self, name: str, rgba: Sequence[float]) -> None:
        """Colour of a body in pictures."""
        for part in self._bodies[name]:
            pybullet.changeVisualShape(part, -1, rgbaColor=list(rgba), physicsClientId=self._client)

    def remove_body(self, name: str) -> None:
        """Take a body out."""
        for part in self._bodies.pop(name):
            pybullet.removeBody(part, physicsClientId=self._client)

    def set_joints(self, values: Mapping[str, float]) -> None:
        """Joint values by name, rad or m. Raises RobotError for a joint the arm does not have."""
        for name, value in values.items():
            if name not in self._joints:
                raise RobotError(f"the arm has no joint '{name}'; it has: {', '.join(self._joints)}")
            pybullet.resetJointState(self._arm, self._joints[name], float(value), physicsClientId=self._client)

    def contacts(self, within_m: float = 0.0, bodies: Sequence[str] | None = None) -> list[Contact]:
        """Links nearer than within_m to the named bodies (all by default), the nearest point of each pair."""
        nearest: dict[tuple[str, str], float] = {}
        for name in self._bodies if bodies is None else bodies:
            for part in self._bodies[name]:
                for p in pybullet.getClosestPoints(self._arm, part, max(within_m, 1e-6), physicsClientId=self._client):
                    key = (self._links[p[3]], name)
                    nearest[key] = min(nearest.get(key, np.inf), p[8])
        return [Contact(link, body, d) for (link, body), d in nearest.items() if d <= within_m]

    def self_contacts(self, pairs: Sequence[tuple[str, str]], within_m: float = 0.0) -> list[Contact]:
        """The same between links of the arm, for the pairs of link names given."""
        found = []
        for a, b in pairs:
            points = pybullet.getClosestPoints(
                self._arm, self._arm, max(within_m, 1e-6), self._index[a], self._index[b], physicsClientId=self._client
            )
            d = min((p[8] for p in points), default=np.inf)
            if d <= within_m:
                found.append(Contact(a, b, d))
        return found

    def link_pose(self, link: str) -> FloatArray:
        """Pose (4, 4) of a link's frame as PyBullet computes it; base_link is the world's origin."""
        if link == "base_link":
            return np.eye(4)
        if link not in self._index:
            raise RobotError(f"the arm has no link '{link}'; it has: {', '.join(self._index)}")
        state = pybullet.getLinkState(
            self._arm, self._index[link], computeForwardKinematics=1, physicsClientId=self._client
        )
        T = np.eye(4)
        T[:3, :3] = np.array(pybullet.getMatrixFromQuaternion(state[5])).reshape(3, 3)
        T[:3, 3] = state[4]
        return T

    def picture(
        self, eye_m: Sequence[float], target_m: Sequence[float], size: tuple[int, int] = (960, 720)
    ) -> npt.NDArray[np.uint8]:
        """What the scene looks like from eye_m towards target_m: (H, W, 3) uint8 RGB by PyBullet's own renderer."""
        view = pybullet.computeViewMatrix(list(eye_m), list(target_m), (0, 0, 1))
        lens = pybullet.computeProjectionMatrixFOV(40, size[0] / size[1], 0.02, 10)
        _, _, rgba, _, _ = pybullet.getCameraImage(
            size[0], size[1], view, lens, renderer=pybullet.ER_TINY_RENDERER, physicsClientId=self._client
        )
        return np.asarray(rgba, dtype=np.uint8).reshape(size[1], size[0], 4)[:, :, :3]
