"""A body of our own, lofted from rounded cones: no data set needed, same interface as the MakeHuman one.

Segment lengths are Drillis and Contini's fractions of stature (in Winter, Biomechanics, fig. 4.1).
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.people.body import Body, Floats32, Ints32, strongest, vertex_normals
from teleop.people.labels import face_parts
from teleop.people.pose import unit
from teleop.people.rig import BONE, CROWN_TO_SKULL_M, FINGERS, N_BONES, SIDES, Floats, Rig, neck_base_m
from teleop.people.shape import Shape

_AROUND: Final = 18
_FINGER_AROUND: Final = 8


class _Mesh:
    """Collects lofted tubes."""

    def __init__(self) -> None:
        self.points: list[Floats] = []
        self.faces: list[Ints32] = []
        self.weights: list[Floats] = []
        self._count = 0

    def loft(self, rings: Floats, weights: Floats) -> None:
        """A closed tube through rings (R, n, 3), counter-clockwise seen from its end; weights (R, 55) per ring."""
        r, n, _ = rings.shape
        ends = rings[[0, -1]].mean(axis=1)
        i, k = np.meshgrid(np.arange(r - 1), np.arange(n), indexing="ij")
        a, b = i * n + k, i * n + (k + 1) % n
        quads = np.stack([a, b, b + n, a, b + n, a + n], axis=-1).reshape(-1, 3)
        rim, last = np.arange(n), (r - 1) * n
        bottom = np.stack([np.full(n, r * n), (rim + 1) % n, rim], axis=-1)
        top = np.stack([np.full(n, r * n + 1), last + rim, last + (rim + 1) % n], axis=-1)
        self.points.append(np.concatenate([rings.reshape(-1, 3), ends]))
        self.weights.append(np.concatenate([np.repeat(weights, n, axis=0), weights[[0, -1]]]))
        self.faces.append((np.concatenate([quads, bottom, top]) + self._count).astype(np.int32))
        self._count += r * n + 2

    def cone(
        self, a: npt.ArrayLike, b: npt.ArrayLike, ra: float, rb: float, bones: tuple[str, ...], wide: float = 1.0
    ) -> None:
        """A rounded cone from a to b; the bones share it in equal lengths. wide: stretch across x."""
        a, b = np.asarray(a, np.float64), np.asarray(b, np.float64)
        d = unit(b - a)
        side = unit(np.cross(d, (0.0, 0.0, 1.0)) if abs(d[2]) < 0.9 else np.cross(d, (1.0, 0.0, 0.0)))
        other = np.cross(d, side)
        quarter = np.radians([80, 55, 30, 0])
        along = np.concatenate([-ra * np.sin(quarter), np.linspace(0.15, 0.85, 6), rb * np.sin(quarter[::-1])])
        length = float(np.linalg.norm(b - a))
        where = np.concatenate([along[:4], along[4:10] * length, length + along[10:]])
        radius = np.concatenate(
            [ra * np.cos(quarter), np.interp(along[4:10], [0, 1], [ra, rb]), rb * np.cos(quarter[::-1])]
        )
        angle = np.linspace(0, 2 * np.pi, _AROUND if max(ra, rb) > 0.015 else _FINGER_AROUND, endpoint=False)
        circle = np.cos(angle)[:, None] * side * wide + np.sin(angle)[:, None] * other
        rings = a + where[:, None, None] * d + radius[:, None, None] * circle
        weights = np.zeros((len(where), N_BONES))
        owner = np.clip((where / length * len(bones)).astype(int), 0, len(bones) - 1)
        weights[np.arange(len(where)), [BONE[bones[k]] for k in owner]] = 1.0
        self.loft(rings, weights)


def _skeleton(h: float) -> tuple[Floats, Floats]:
    """Bone heads (55, 3) and finger tips (2, 5, 3) at rest, arms 45 degrees out, palms down."""
    heads, tips = np.zeros((N_BONES, 3)), np.zeros((2, 5, 3))

    def put(name: str, x: float, y: float, z: float = 0.0) -> None:
        heads[BONE[name]] = (x, y, z)

    put("pelvis", 0, 0.545 * h)
    put("spine", 0, 0.60 * h)
    put("chest", 0, 0.69 * h)
    put("neck", 0, 0.85 * h)
    put("head", 0, 0.885 * h)
    for i, (side, sign) in enumerate(zip(SIDES, (1.0, -1.0), strict=True)):
        arm = unit(np.array([sign, -1.0, 0.0]))
        shoulder = np.array([sign * 0.108 * h, 0.818 * h, 0.0])
        elbow, wrist = shoulder + 0.186 * h * arm, shoulder + 0.332 * h * arm
        chain = {
            "clavicle": np.array([sign * 0.02 * h, 0.83 * h, 0.0]),
            "upper_arm": shoulder,
            "upper_arm_twist": (shoulder + elbow) / 2,
            "forearm": elbow,
            "forearm_twist": (elbow + wrist) / 2,
            "hand": wrist,
        }
        for name, p in chain.items():
            heads[BONE[f"{name}_{side}"]] = p
        forward = np.array([0.0, 0.0, -1.0])
        for k, finger in enumerate(FINGERS):
            if finger == "thumb":
                base, d = wrist + 0.012 * h * arm + 0.014 * h * forward, unit(arm + 0.7 * forward)
                length = 0.042 * h
            else:
                base = wrist + 0.046 * h * arm + (0.0150 - 0.0100 * (k - 1)) * h * forward
                d, length = unit(arm + (0.08 - 0.055 * (k - 1)) * forward), (0.041, 0.046, 0.043, 0.034)[k - 1] * h
            for segment, part in enumerate((0.0, 0.45, 0.75)):
                heads[BONE[f"{finger}{segment + 1}_{side}"]] = base + part * length * d
            tips[i, k] = base + length * d
        put(f"thigh_{side}", sign * 0.055 * h, 0.530 * h)
        put(f"shin_{side}", sign * 0.057 * h, 0.285 * h)
        put(f"foot_{side}", sign * 0.058 * h, 0.042 * h, 0.01 * h)
        put(f"toes_{side}", sign * 0.062 * h, 0.014 * h, -0.072 * h)
    return heads, tips


def _torso(mesh: _Mesh, h: float, girth: float) -> None:
    # height, half width and half depth as fractions of stature, and the bone that carries the ring
    rows = (
        (0.475, 0.060, 0.045, "pelvis"),
        (0.500, 0.096, 0.066, "pelvis"),
        (0.540, 0.101, 0.070, "pelvis"),
        (0.580, 0.095, 0.066, "pelvis"),
        (0.625, 0.086, 0.062, "spine"),
        (0.670, 0.088, 0.064, "spine"),
        (0.720, 0.098, 0.070, "chest"),
        (0.770, 0.105, 0.070, "chest"),
        (0.810, 0.104, 0.060, "chest"),
        (0.835, 0.080, 0.046, "chest"),
        (0.850, 0.040, 0.038, "chest"),
        (0.858, 0.022, 0.025, "neck"),
    )
    angle = np.linspace(0, 2 * np.pi, 2 * _AROUND, endpoint=False)
    rings, weights = [], np.zeros((len(rows), N_BONES))
    for k, (y, rx, rz, bone) in enumerate(rows):
        x, z = np.cos(angle), -np.sin(angle)
        square = (np.abs(x) ** 2.6 + np.abs(z) ** 2.6) ** (-1 / 2.6)
        rings.append(np.stack([rx * girth * square * x, np.full_like(x, y), rz * girth * square * z], axis=1) * h)
        weights[k, BONE[bone]] = 1.0
    blend = np.array(weights)
    blend[1:-1] = 0.25 * weights[:-2] + 0.5 * weights[1:-1] + 0.25 * weights[2:]
    mesh.loft(np.stack(rings), blend)


def builtin_body(shape: Shape | None = None) -> Body:
    """An operator of the given height and mass; sex, age and descent change nothing here."""
    shape = shape or Shape()
    h = shape.height_m
    girth = float(np.sqrt(shape.mass_kg / (22.5 * h * h)))
    heads, tips = _skeleton(h)
    mesh = _Mesh()
    _torso(mesh, h, girth)
    at = {name: heads[i] for name, i in BONE.items()}
    up = np.array([0.0, 1.0, 0.0])
    mesh.cone(at["neck"] - 0.01 * h * up, at["head"] + 0.01 * h * up, 0.034 * h, 0.032 * h, ("neck",))
    skull = np.array([0.0, h - CROWN_TO_SKULL_M, -0.008 * h])

    def by_skull(y: float, z: float) -> Floats:
        return skull + h * np.array([0.0, y, z])

    mesh.cone(by_skull(-0.030, -0.006), by_skull(CROWN_TO_SKULL_M / h - 0.047, 0.0), 0.037 * h, 0.047 * h, ("head",))
    mesh.cone(by_skull(-0.014, -0.040), by_skull(-0.026, -0.050), 0.006 * h, 0.009 * h, ("head",))
    for i, side in enumerate(SIDES):
        limb = {
            name: at[f"{name}_{side}"] for name in ("upper_arm", "forearm", "hand", "thigh", "shin", "foot", "toes")
        }
        g = girth * h

        def bones(*names: str, of: str = side) -> tuple[str, ...]:
            return tuple(f"{name}_{of}" for name in names)

        mesh.cone(at[f"clavicle_{side}"], limb["upper_arm"], 0.030 * g, 0.036 * g, bones("clavicle"))
        mesh.cone(limb["upper_arm"], limb["forearm"], 0.033 * g, 0.025 * g, bones("upper_arm", "upper_arm_twist"))
        mesh.cone(limb["forearm"], limb["hand"], 0.026 * g, 0.016 * g, bones("forearm", "forearm_twist"))
        mesh.cone(limb["thigh"], limb["shin"], 0.050 * g, 0.034 * g, bones("thigh"))
        mesh.cone(limb["shin"], limb["foot"], 0.034 * g, 0.022 * g, bones("shin"))
        mesh.cone(limb["foot"] + [0, -0.018 * h, 0.012 * h], limb["toes"], 0.023 * h, 0.016 * h, bones("foot"), 1.2)
        mesh.cone(limb["toes"], limb["toes"] + [0, 0, -0.026 * h], 0.016 * h, 0.013 * h, bones("toes"), 1.4)
        _hand(mesh, at, tips[i], side, h)
    points = np.concatenate(mesh.points)
    points[:, 1] -= points[:, 1].min()
    vertices: Floats32 = points.astype(np.float32)
    faces = np.concatenate(mesh.faces)
    bone, weight = strongest(np.concatenate(mesh.weights))
    knuckles = np.stack([np.mean([at[f"{f}1_{s}"] for f in FINGERS[1:]], axis=0) for s in SIDES])
    palms = np.stack([unit(np.array([-sign, -1.0, 0.0])) for sign in (1.0, -1.0)])
    rig = Rig(heads, skull, neck_base_m(heads), knuckles, palms, tips)
    owner = bone[:, 0].copy()
    parts = face_parts(rig, vertices, faces, owner)
    return Body(rig, vertices, vertex_normals(vertices, faces), faces, bone, weight, parts, owner, h)


def _hand(mesh: _Mesh, at: dict[str, Floats], tips: Floats, side: str, h: float) -> None:
    wrist, knuckles = at[f"hand_{side}"], [at[f"{f}1_{side}"] for f in FINGERS]
    for knuckle in knuckles[1:]:
        start = wrist + 0.15 * (knuckle - wrist)
        mesh.cone(start, knuckle, 0.0085 * h, 0.0080 * h, (f"hand_{side}",))
    mesh.cone(wrist, knuckles[0], 0.011 * h, 0.0085 * h, (f"hand_{side}",))
    for k, finger in enumerate(FINGERS):
        chain = [at[f"{finger}{s}_{side}"] for s in (1, 2, 3)] + [tips[k]]
        for s in range(3):
            ra, rb = (0.0056, 0.0054, 0.0050, 0.0044)[s : s + 2]
            mesh.cone(chain[s], chain[s + 1], ra * h, rb * h, (f"{finger}{s + 1}_{side}",))
