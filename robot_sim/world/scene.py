"""The greenhouse as PyBullet bodies: what the robot can run into, and meshes for the camera."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pybullet

from robot_sim.primitives import Primitive
from robot_sim.world.client import Client
from robot_sim.world.meshes import Mesh


def load_floor(client: Client) -> None:
    """The floor on which the tracks grip."""
    floor = client.createMultiBody(0.0, client.createCollisionShape(pybullet.GEOM_PLANE), _unseen(client))
    client.changeDynamics(floor, -1, lateralFriction=1.0)


def load_obstacles(client: Client, boxes: Sequence[Primitive]) -> int:
    """One body of all solid boxes; its number."""
    shape = client.createCollisionShapeArray(
        shapeTypes=[pybullet.GEOM_BOX] * len(boxes),
        halfExtents=[[0.5 * s for s in b.size_m] for b in boxes],
        collisionFramePositions=[b.xyz_m for b in boxes],
    )
    return int(client.createMultiBody(0.0, shape, _unseen(client)))


class Looks:
    """Bodies that are only seen, in the form PyBullet takes.

    PyBullet never lets go of a list that it was given. Made once, the lists are the same at every rebuilding of the
    scene, and only a count of references grows; made anew, 6 MB were lost with every reset.
    """

    def __init__(self, meshes: Sequence[Mesh]) -> None:
        self._shapes = tuple(
            {
                "vertices": mesh.vertices_m.tolist(),
                "indices": mesh.triangles.ravel().tolist(),
                "normals": mesh.normals.tolist(),
                "uvs": np.zeros((len(mesh.vertices_m), 2)).tolist(),
                "rgbaColor": list(mesh.rgba),
            }
            for mesh in meshes
        )

    def load(self, client: Client) -> None:
        """Put them into the scene."""
        for shape in self._shapes:
            look = client.createVisualShape(pybullet.GEOM_MESH, **shape)
            client.createMultiBody(0.0, baseVisualShapeIndex=look)


def _unseen(client: Client) -> int:
    # a speck under the floor: without a look of its own PyBullet draws the collision shape
    speck = client.createVisualShape(pybullet.GEOM_BOX, halfExtents=[1e-4] * 3, visualFramePosition=[0.0, 0.0, -1.0])
    return int(speck)
