"""Fruit in the physics: it hangs by a constraint until its peduncle is cut, and is held only by both fingers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import pybullet

from robot_sim.config import ToolConfig
from robot_sim.plants import PEDUNCLE_M, TOUGHNESS, Fruit
from robot_sim.urdf_parts_tools import BOX_SIZE_M, CUT_HALF_M, CUT_MIDDLE_M
from robot_sim.world.body import LinkPose, Motion, motion, put
from robot_sim.world.client import Client

MOVED_M = 0.004
"""A hanging fruit that swings less than this is drawn where it was."""
FLOOR_M = 0.12
STIFF = 5.0
FRUIT_N_M = 2.0e4
"""A cucumber between two plates gives about 1 mm for 20 N."""
FRUIT_NS_M = {"cucumber": 40.0, "tomato": 10.0, "grape": 10.0}
"""Damping of one contact: fruit swings no more than it bounces; a berry is a tenth of a cucumber."""


class FruitStatus(StrEnum):
    """Where a fruit is."""

    HANGING = "hanging"
    HELD = "held"
    LOOSE = "loose"
    BOXED = "boxed"
    DROPPED = "dropped"


@dataclass(frozen=True, slots=True)
class FruitContact:
    """The robot touches a fruit: with which link, how hard [N]."""

    fruit: int
    link: int
    force_n: float


class Crops:
    """All fruit of one world. Rebuilt with it."""

    def __init__(self, client: Client, fruits: Sequence[Fruit], tool: ToolConfig) -> None:
        self._client = client
        self._fruits = fruits
        self._tool = tool
        self._bodies = [_body(client, fruit) for fruit in fruits]
        self.index = {body: i for i, body in enumerate(self._bodies)}
        self._pegs: list[int | None] = [self._peg(i) for i in range(len(fruits))]
        self.damaged = [False] * len(fruits)
        self.status = [FruitStatus.HANGING] * len(fruits)

    @property
    def attached(self) -> list[bool]:
        """Which fruit hangs by its peduncle."""
        return [peg is not None for peg in self._pegs]

    def detach(self, i: int) -> None:
        """Part the peduncle of one fruit."""
        peg = self._pegs[i]
        if peg is not None:
            self._client.removeConstraint(peg)
            self._pegs[i] = None

    def cut(self, tool: LinkPose) -> tuple[int, ...]:
        """The blades have closed: peduncles between them part. Returns whose."""
        parted = tuple(i for i, hangs in enumerate(self.attached) if hangs and self._between_blades(i, tool))
        for i in parted:
            self.detach(i)
        return parted

    def press(self, contacts: Iterable[FruitContact]) -> None:
        """What is pressed too hard in this tick is damaged; a blow lasts no longer."""
        for contact in contacts:
            if contact.force_n > self._tool.bruise_n * TOUGHNESS[self._fruits[contact.fruit].crop]:
                self.damaged[contact.fruit] = True

    def observe(self, contacts: Iterable[FruitContact], fingers: tuple[int, int], box: LinkPose) -> None:
        """Find out where every fruit is now."""
        touching: dict[int, set[int]] = {}
        for contact in contacts:
            touching.setdefault(contact.fruit, set()).add(contact.link)
        for i in touching:
            self._tear(i)
        for i, peg in enumerate(self._pegs):
            if touching.get(i, set()).issuperset(fingers):
                self.status[i] = FruitStatus.HELD
            elif peg is not None:
                self.status[i] = FruitStatus.HANGING
            else:
                xyz = np.array(self._client.getBasePositionAndOrientation(self._bodies[i])[0])
                inside = np.abs(box.local(xyz)) <= 0.5 * np.array(BOX_SIZE_M)
                boxed, low = bool(inside.all()), bool(xyz[2] < FLOOR_M)
                self.status[i] = FruitStatus.BOXED if boxed else FruitStatus.DROPPED if low else FruitStatus.LOOSE

    def motions(self) -> tuple[Motion, ...]:
        """How every fruit lies and moves."""
        return tuple(motion(self._client, body) for body in self._bodies)

    def put(self, motions: Sequence[Motion]) -> None:
        """Lay all fruit down as it was."""
        for body, m in zip(self._bodies, motions, strict=True):
            put(self._client, body, m)

    def report(self) -> dict[str, str]:
        """Fruit that is not just hanging: name -> status, with ``+damaged``."""
        return {
            fruit.name: f"{status}+damaged" if damaged else str(status)
            for fruit, status, damaged in zip(self._fruits, self.status, self.damaged, strict=True)
            if damaged or status is not FruitStatus.HANGING
        }

    def moved(self) -> dict[str, tuple[float, ...]]:
        """Poses of the parts of all fruit that is no longer where it grew."""
        poses: dict[str, tuple[float, ...]] = {}
        for fruit, body in zip(self._fruits, self._bodies, strict=True):
            xyz, quaternion = self._client.getBasePositionAndOrientation(body)
            if max(abs(a - b) for a, b in zip(xyz, fruit.xyz_m, strict=True)) < MOVED_M:
                continue
            for part in fruit.parts:
                offset = tuple(p - c for p, c in zip(part.xyz_m, fruit.xyz_m, strict=True))
                turned = self._client.getQuaternionFromEuler(part.rpy_rad)
                at, q = self._client.multiplyTransforms(xyz, quaternion, offset, turned)
                poses[part.name] = (*at, *q)
        return poses

    def _peg(self, i: int) -> int:
        fruit = self._fruits[i]
        x, y, z = fruit.xyz_m
        peg = self._client.createConstraint(
            self._bodies[i], -1, -1, -1, pybullet.JOINT_POINT2POINT, [0, 0, 0],
            parentFramePosition=[0.0, 0.0, fruit.top_m + 0.5 * PEDUNCLE_M],
            childFramePosition=[x, y, z + fruit.top_m + 0.5 * PEDUNCLE_M],
        )  # fmt: skip
        # stiffer than it is strong: beyond its strength it tears instead of giving
        self._client.changeConstraint(peg, maxForce=STIFF * self._tool.peduncle_n)
        return int(peg)

    def _tear(self, i: int) -> None:
        """A peduncle pulled beyond its strength parts, and the fruit is spoilt."""
        peg = self._pegs[i]
        if peg is not None and np.linalg.norm(self._client.getConstraintState(peg)) > self._tool.peduncle_n:
            self.detach(i)
            self.damaged[i] = True

    def _between_blades(self, i: int, tool: LinkPose) -> bool:
        xyz, quaternion = self._client.getBasePositionAndOrientation(self._bodies[i])
        up = np.array(self._client.getMatrixFromQuaternion(quaternion)).reshape(3, 3)[:, 2]
        begin = np.array(xyz) + self._fruits[i].top_m * up
        # a point every 5 mm of the peduncle
        steps = np.linspace(0.0, PEDUNCLE_M, 17)
        points = np.array([tool.local(begin + s * up) for s in steps])
        return bool((np.abs(points - CUT_MIDDLE_M) <= CUT_HALF_M).all(axis=1).any())


def _body(client: Client, fruit: Fruit) -> int:
    """One dynamic body; a cucumber collides as a capsule, a truss as its tomatoes."""
    offsets = [[p - c for p, c in zip(part.xyz_m, fruit.xyz_m, strict=True)] for part in fruit.parts]
    if fruit.crop == "cucumber":
        radius, length = fruit.parts[0].size_m
        shape = client.createCollisionShape(pybullet.GEOM_CAPSULE, radius=radius, height=length - 2 * radius)
    else:
        balls = [(part, at) for part, at in zip(fruit.parts, offsets, strict=True) if part.kind == "sphere"]
        shape = client.createCollisionShapeArray(
            shapeTypes=[pybullet.GEOM_SPHERE] * len(balls),
            radii=[part.size_m[0] for part, _ in balls],
            collisionFramePositions=[at for _, at in balls],
        )
    kinds = {"sphere": pybullet.GEOM_SPHERE, "cylinder": pybullet.GEOM_CYLINDER}
    look = client.createVisualShapeArray(
        shapeTypes=[kinds[part.kind] for part in fruit.parts],
        radii=[part.size_m[0] for part in fruit.parts],
        lengths=[part.size_m[-1] for part in fruit.parts],
        rgbaColors=[part.rgba for part in fruit.parts],
        visualFramePositions=offsets,
        visualFrameOrientations=[client.getQuaternionFromEuler(part.rpy_rad) for part in fruit.parts],
    )
    body = client.createMultiBody(fruit.mass_kg, shape, look, fruit.xyz_m)
    client.changeDynamics(
        body,
        -1,
        lateralFriction=0.8,
        rollingFriction=0.0005,
        angularDamping=0.9,
        linearDamping=0.2,
        contactStiffness=FRUIT_N_M,
        contactDamping=FRUIT_NS_M[fruit.crop],
        activationState=pybullet.ACTIVATION_STATE_ENABLE_SLEEPING,
    )
    return int(body)
