"""Rooms: floor, walls, and furniture as boxes and leaves. Levelled axes, origin on the floor under the sensor."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numba
import numpy as np
import numpy.typing as npt

from teleop.frames import Camera
from teleop.people.body import Floats32, Ints32
from teleop.people.meshes import Mesh
from teleop.people.render import Raster, camera_vector
from teleop.people.rig import Floats
from teleop.people.view import View


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """normal (P, 3), offset_m (P,): planes n x = offset, plane 0 the floor. plane_rgb (P, 3), plane_texture (P,) 0..1.

    vertices_m (V, 3), faces (F, 3), face_rgb (F, 3): furniture.
    """

    normal: Floats
    offset_m: Floats
    plane_rgb: Floats
    plane_texture: Floats
    vertices_m: Floats32 = field(default_factory=lambda: np.zeros((0, 3), np.float32))
    faces: Ints32 = field(default_factory=lambda: np.zeros((0, 3), np.int32))
    face_rgb: Floats = field(default_factory=lambda: np.zeros((0, 3)))


_BOX_FACES = np.array(
    [
        (0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4),
        (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5),
    ],
    np.int32,
)  # fmt: skip


class _Pieces:
    def __init__(self) -> None:
        self.vertices: list[Floats] = []
        self.faces: list[Ints32] = []
        self.rgb: list[Floats] = []
        self.count = 0

    def add(self, vertices: Floats, faces: Ints32, rgb: Floats) -> None:
        self.vertices.append(vertices)
        self.faces.append(faces + self.count)
        self.rgb.append(np.broadcast_to(rgb, (len(faces), 3)))
        self.count += len(vertices)

    def box(self, low: tuple[float, float, float], high: tuple[float, float, float], turn: float, rgb: Floats) -> None:
        corner = np.array([[(low, high)[(i >> a) & 1][a] for a in range(3)] for i in range(8)])
        middle = np.array([(low[0] + high[0]) / 2, 0.0, (low[2] + high[2]) / 2])
        c, s = np.cos(turn), np.sin(turn)
        R = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
        self.add((corner - middle) @ R.T + middle, _BOX_FACES, rgb)

    def plant(self, x: float, z: float, height: float, rng: np.random.Generator) -> None:
        """A pot and a bush of leaves."""
        self.box((x - 0.13, 0.0, z - 0.13), (x + 0.13, 0.25, z + 0.13), 0.3, np.array([150.0, 85.0, 60.0]))
        n = 70
        at = np.stack([rng.normal(x, 0.12, n), rng.uniform(0.25, height, n), rng.normal(z, 0.12, n)], axis=1)
        d = rng.normal(0, 1, (n, 3)) + np.array([0, 0.4, 0])
        d *= rng.uniform(0.08, 0.2, (n, 1)) / np.linalg.norm(d, axis=1, keepdims=True)
        across = np.cross(d, rng.normal(0, 1, (n, 3)))
        across *= 0.04 / np.linalg.norm(across, axis=1, keepdims=True)
        leaf = np.stack([at, at + d / 2 + across, at + d, at + d / 2 - across], axis=1).reshape(-1, 3)
        base = 4 * np.arange(n)[:, None]
        faces = np.concatenate([base + np.array([0, 1, 2]), base + np.array([0, 2, 3])]).astype(np.int32)
        green = np.array([60.0, 120.0, 45.0]) * rng.uniform(0.6, 1.4, (n, 1))
        self.add(leaf, faces, np.concatenate([green, green]))

    def table(self, x: float, z: float, turn: float, rgb: Floats) -> None:
        """A table 0.74 m high."""
        self.box((x - 0.6, 0.71, z - 0.35), (x + 0.6, 0.74, z + 0.35), turn, rgb)
        for dx in (-0.55, 0.55):
            self.box((x + dx - 0.03, 0.0, z - 0.3), (x + dx + 0.03, 0.71, z + 0.3), turn, 0.8 * rgb)

    def chair(self, x: float, z: float, rgb: Floats) -> None:
        """A chair facing the sensor."""
        self.box((x - 0.22, 0.42, z - 0.22), (x + 0.22, 0.46, z + 0.22), 0.0, rgb)
        self.box((x - 0.22, 0.46, z + 0.18), (x + 0.22, 0.95, z + 0.22), 0.0, rgb)
        for dx in (-0.2, 0.2):
            self.box((x + dx - 0.02, 0.0, z - 0.2), (x + dx + 0.02, 0.42, z + 0.2), 0.0, 0.7 * rgb)


def _room(walls: list[tuple[Floats, float, Floats, float]], pieces: _Pieces) -> Room:
    normal, offset, rgb, texture = (np.array(column, dtype=np.float64) for column in zip(*walls, strict=True))
    if not pieces.count:
        return Room(normal, offset, rgb, texture)
    vertices = np.concatenate(pieces.vertices).astype(np.float32)
    return Room(normal, offset, rgb, texture, vertices, np.concatenate(pieces.faces), np.concatenate(pieces.rgb))


def random_room(rng: np.random.Generator, keep_clear_m: Floats) -> Room:
    """Floor, two to four planes and some furniture; keep_clear_m (3,): where the person stands."""

    def paint() -> Floats:
        return rng.uniform(60, 230) * (1 + rng.uniform(-0.15, 0.15, 3))

    x0, z0 = float(keep_clear_m[0]), float(keep_clear_m[2])
    walls = [(np.array([0.0, 1.0, 0.0]), 0.0, paint(), float(rng.uniform(0, 0.5)))]
    turn = rng.normal(0, 0.12)
    walls.append((np.array([np.sin(turn), 0.0, np.cos(turn)]), z0 + float(rng.uniform(0.5, 3.0)), paint(), 0.1))
    for sign in (-1.0, 1.0):
        if rng.uniform() < 0.6:
            wall = float(max(sign * x0 + 0.8, rng.uniform(1.2, 3.5)))
            walls.append((np.array([sign, 0.0, rng.normal(0, 0.03)]), wall, paint(), 0.1))
    if rng.uniform() < 0.3:
        walls.append((np.array([0.0, 1.0, 0.0]), float(rng.uniform(2.3, 3.0)), paint(), 0.05))
    pieces = _Pieces()
    for kind in rng.integers(0, 4, int(rng.integers(0, 5))):
        x, z = x0 + float(rng.choice([-1.0, 1.0])) * float(rng.uniform(0.75, 1.6)), z0 + float(rng.uniform(-0.4, 1.2))
        z = max(z, 1.2)
        if kind == 0:
            pieces.plant(x, z, float(rng.uniform(0.5, 1.8)), rng)
        elif kind == 1:
            pieces.table(x + 0.35 * np.sign(x - x0), z, float(rng.normal(0, 0.3)), paint())
        elif kind == 2:
            pieces.chair(x, z, paint())
        else:
            w, h = float(rng.uniform(0.1, 0.35)), float(rng.uniform(0.3, 2.0))
            pieces.box((x - w, 0.0, z - w), (x + w, h, z + w), float(rng.uniform(0, 1.5)), paint())
    return _room(walls, pieces)


def furnished(room: Room, mesh: Mesh, x_m: float, z_m: float, turn_rad: float) -> Room:
    """The room with one more thing at (x, z), turned about the vertical."""
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    R = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    points: Floats32 = (mesh.vertices_m @ R.T + np.array([x_m, 0.0, z_m])).astype(np.float32)
    count = len(room.vertices_m)
    return replace(
        room,
        vertices_m=np.concatenate([room.vertices_m, points]),
        faces=np.concatenate([room.faces, mesh.faces + count]).astype(np.int32),
        face_rgb=np.concatenate([room.face_rgb, np.full((len(mesh.faces), 3), 130.0)]),
    )


def greenhouse_room(seed: int = 0) -> Room:
    """The operator's corner of a greenhouse: floor, back and side walls, plants at the sides, a table."""
    rng = np.random.default_rng(seed)
    floor, back, side = (
        np.array([122.0, 118.0, 110.0]),
        np.array([178.0, 190.0, 186.0]),
        np.array([168.0, 182.0, 172.0]),
    )
    walls = [
        (np.array([0.0, 1.0, 0.0]), 0.0, floor, 0.5),
        (np.array([0.0, 0.0, 1.0]), 4.3, back, 0.12),
        (np.array([1.0, 0.0, 0.05]), 2.3, side, 0.12),
        (np.array([-1.0, 0.0, 0.05]), 2.6, side, 0.12),
    ]
    pieces = _Pieces()
    for x, z, height in ((1.55, 3.6, 1.5), (1.75, 3.0, 1.1), (-1.9, 3.9, 1.6), (-1.3, 4.0, 1.2), (0.9, 4.05, 1.0)):
        pieces.plant(x, z, height, rng)
    pieces.table(-2.0, 3.2, 1.45, np.array([158.0, 124.0, 84.0]))
    return _room(walls, pieces)


@numba.njit(cache=True, nogil=True)
def _planes(
    k: npt.NDArray[np.float64],
    n: npt.NDArray[np.float64],
    offset: npt.NDArray[np.float64],
    depth: Floats32,
    face: Ints32,
) -> None:
    height, width = depth.shape
    for v in range(height):
        for u in range(width):
            x, y = (u - k[2]) / k[0], -(v - k[3]) / k[1]
            for p in range(n.shape[0]):
                toward = n[p, 0] * x + n[p, 1] * y + n[p, 2]
                z = offset[p] / toward if toward != 0.0 else -1.0
                if 0.3 < z < depth[v, u]:
                    depth[v, u] = z
                    face[v, u] = -2 - p


def draw_planes(raster: Raster, camera: Camera, room: Room, view: View) -> None:
    """Floor and walls behind everything drawn so far; plane p is written as face -2 - p."""
    # n x = o in the room is (R n) c = o + (R n) t in camera axes.
    n = room.normal @ view.R.T
    _planes(camera_vector(camera), n, room.offset_m + n @ view.t_m, raster.depth_m, raster.face)
