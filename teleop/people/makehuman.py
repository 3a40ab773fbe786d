"""People from the MakeHuman base mesh: shaped by sex, age, muscle, weight, height and descent.

Files (CC0, from the MakeHuman project): ``3dobjs/base.obj``, ``rigs/default.mhskel``, ``rigs/default_weights.mhw`` and
``targets/macrodetails``. Their axes are decimetres, y up, facing +z; ours are metres, facing -z (see the package).
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.data import data_folder
from teleop.errors import DataError
from teleop.people.body import Body, Floats32, Ints32, strongest, vertex_normals
from teleop.people.labels import face_parts
from teleop.people.rig import BONE, BONE_NAMES, CROWN_TO_SKULL_M, FINGERS, N_BONES, SIDES, Floats, Rig, neck_base_m
from teleop.people.shape import Shape

_TO_METRES: Final = np.array([-0.1, 0.1, -0.1])
"""Decimetres facing +z to metres facing -z (half a turn about the vertical)."""
_DENSITY_KG_M3: Final = 1010.0
"""Of a whole human body, lungs filled on average (Durnin and Womersley 1974: 1.00-1.09)."""
_FROM_MAKEHUMAN: Final = {
    "pelvis": ("root", "pelvis.L", "pelvis.R", "spine05"),
    "spine": ("spine04", "spine03"),
    "chest": ("spine02", "spine01", "breast.L", "breast.R"),
    "neck": ("neck01", "neck02", "neck03"),
    "head": ("head",),
    **{
        f"{ours}_{side}": tuple(f"{name}.{letter}" for name in theirs)
        for side, letter in (("right", "R"), ("left", "L"))
        for ours, theirs in (
            ("clavicle", ("clavicle", "shoulder01")),
            ("upper_arm", ("upperarm01",)),
            ("upper_arm_twist", ("upperarm02",)),
            ("forearm", ("lowerarm01",)),
            ("forearm_twist", ("lowerarm02",)),
            ("hand", ("wrist", "metacarpal1", "metacarpal2", "metacarpal3", "metacarpal4")),
            ("thigh", ("upperleg01", "upperleg02")),
            ("shin", ("lowerleg01", "lowerleg02")),
            ("foot", ("foot",)),
            ("toes", ("toe3-1", "toe1-1", "toe2-1", "toe4-1", "toe5-1")),
            *((f"{f}{k}", (f"finger{n + 1}-{k}",)) for n, f in enumerate(FINGERS) for k in (1, 2, 3)),
        )
    },
}


@dataclass(frozen=True, slots=True, eq=False)
class _Base:
    """The files, read once: all 19158 vertices in metres, the skin's triangles, weights and joint vertices."""

    folder: Path
    vertices_m: Floats
    faces: Ints32
    n_skin: int
    bone: Ints32
    weight: Floats32
    vertex_bone: Ints32
    head_vertices: tuple[npt.NDArray[np.int64], ...]
    tip_vertices: tuple[npt.NDArray[np.int64], ...]


def _read_obj(path: Path) -> tuple[Floats, Ints32]:
    vertices, faces, group = [], [], ""
    for line in path.read_text().splitlines():
        if line.startswith("v "):
            vertices.append([float(v) for v in line.split()[1:4]])
        elif line.startswith("g "):
            group = line[2:].strip()
        elif group == "body" and line.startswith("f "):
            q = [int(c.split("/")[0]) - 1 for c in line.split()[1:]]
            faces += [[q[0], q[k], q[k + 1]] for k in range(1, len(q) - 1)]
    return np.array(vertices) * _TO_METRES, np.array(faces, np.int32)


def _base() -> _Base:
    return _load(data_folder("makehuman"))


@lru_cache(maxsize=1)
def _load(folder: Path) -> _Base:
    try:
        vertices, faces = _read_obj(folder / "3dobjs" / "base.obj")
        skeleton = json.loads((folder / "rigs" / "default.mhskel").read_text())
        weights = json.loads((folder / "rigs" / "default_weights.mhw").read_text())["weights"]
    except (OSError, ValueError, KeyError) as error:
        raise DataError(f"MakeHuman files in {folder} cannot be read ({error}); fetch them again") from error
    bones, joints = skeleton["bones"], skeleton["joints"]
    ours = {theirs: BONE[name] for name, many in _FROM_MAKEHUMAN.items() for theirs in many}

    def owner(name: str) -> int:
        while name not in ours:
            name = bones[name]["parent"]
        return ours[name]

    n_skin = int(faces.max()) + 1
    dense = np.zeros((n_skin, N_BONES))
    for name, rows in weights.items():
        for vertex, w in rows:
            if vertex < n_skin:
                dense[vertex, owner(name)] += w
    bone, weight = strongest(dense)
    first = [_FROM_MAKEHUMAN[name][0] for name in BONE_NAMES]
    tips = [f"finger{n + 1}-3.{letter}" for letter in ("R", "L") for n in range(5)]
    return _Base(
        folder,
        vertices,
        faces,
        n_skin,
        bone,
        weight,
        bone[:, 0].copy(),
        tuple(np.array(joints[bones[b]["head"]]) for b in first),
        tuple(np.array(joints[bones[b]["tail"]]) for b in tips),
    )


@lru_cache(maxsize=160)
def _target(folder: Path, name: str) -> Floats32:
    """Displacements (19158, 3) in metres of one target file."""
    path = folder / "targets" / "macrodetails" / f"{name}.target"
    try:
        text = "\n".join(line for line in path.read_text().splitlines() if not line.startswith("#"))
    except OSError as error:
        raise DataError(f"MakeHuman target {path} cannot be read ({error}); fetch it again") from error
    rows = np.array(text.split(), np.float64).reshape(-1, 4)
    out = np.zeros(_load(folder).vertices_m.shape, np.float32)
    out[rows[:, 0].astype(np.int64)] = rows[:, 1:] * _TO_METRES
    return out


def _thirds(value: float, word: str) -> list[tuple[str, float]]:
    """min, average, max with their weights: average is 1 at 0.5 and falls to 0 at 0 and 1."""
    rows = [(f"min{word}", max(0.0, 1 - 2 * value)), (f"max{word}", max(0.0, 2 * value - 1))]
    rows.append((f"average{word}", 1 - rows[0][1] - rows[1][1]))
    return [(name, w) for name, w in rows if w > 0]


def _vertices(shape: Shape, weight: float, height: float) -> Floats:
    base = _base()
    out = base.vertices_m.copy()
    for sex, ws in (("male", 1 - shape.female), ("female", shape.female)):
        for age, wa in (("young", 1 - shape.age), ("old", shape.age)):
            if ws * wa == 0:
                continue
            for descent, wd in zip(("african", "asian", "caucasian"), shape.descent, strict=True):
                if wd > 0:
                    out += ws * wa * wd * _target(base.folder, f"{descent}-{sex}-{age}")
            for muscle, wm in _thirds(shape.muscle, "muscle"):
                for mass, wk in _thirds(weight, "weight"):
                    w, name = ws * wa * wm * wk, f"{sex}-{age}-{muscle}-{mass}"
                    out += w * _target(base.folder, f"universal-{name}")
                    for tall, wh in _thirds(height, "height"):
                        if not tall.startswith("average"):
                            out += w * wh * _target(base.folder, f"height/{name}-{tall}")
    return out


def _height_m(vertices: Floats) -> float:
    skin = vertices[: _base().n_skin, 1]
    return float(skin.max() - skin.min())


def _mass_kg(vertices: Floats, scale: float) -> float:
    a, b, c = (vertices[_base().faces[:, k]] for k in range(3))
    return _DENSITY_KG_M3 * scale**3 * abs(float(np.einsum("ij,ij->", a, np.cross(b, c)))) / 6.0


def makehuman_body(shape: Shape) -> Body:
    """A person of this shape. Height is exact; mass is met by the weight target as far as that reaches.

    Raises DataError when the MakeHuman files are missing or damaged.
    """
    base = _base()
    low, high = _height_m(_vertices(shape, 0.5, 0.2)), _height_m(_vertices(shape, 0.5, 0.8))
    height = float(np.clip(0.2 + 0.6 * (shape.height_m - low) / (high - low), 0.0, 1.0))
    weights = np.array([0.0, 0.5, 1.0])
    masses = []
    for w in weights:
        v = _vertices(shape, float(w), height)
        masses.append(_mass_kg(v, shape.height_m / _height_m(v)))
    vertices = _vertices(shape, float(np.interp(shape.mass_kg, masses, weights)), height)
    vertices *= shape.height_m / _height_m(vertices)
    vertices[:, 1] -= vertices[: base.n_skin, 1].min()
    return _assemble(base, vertices, shape.height_m)


def _assemble(base: _Base, vertices: Floats, height_m: float) -> Body:
    heads = np.stack([vertices[rows].mean(axis=0) for rows in base.head_vertices])
    tips = np.stack([vertices[rows].mean(axis=0) for rows in base.tip_vertices]).reshape(2, 5, 3)
    skin = vertices[: base.n_skin].astype(np.float32)
    head = skin[base.vertex_bone == BONE["head"]]
    skull = np.array([0.0, height_m - CROWN_TO_SKULL_M, 0.5 * (head[:, 2].min() + head[:, 2].max())])
    knuckles = np.stack([np.mean([heads[BONE[f"{f}1_{s}"]] for f in FINGERS[1:]], axis=0) for s in SIDES])
    palms = []
    for sign, side in ((1.0, "right"), (-1.0, "left")):
        wrist = heads[BONE[f"hand_{side}"]]
        normal = np.cross(heads[BONE[f"index1_{side}"]] - wrist, heads[BONE[f"little1_{side}"]] - wrist)
        palms.append(sign * normal / np.linalg.norm(normal))
    rig = Rig(heads, skull, neck_base_m(heads), knuckles, np.stack(palms), tips)
    parts = face_parts(rig, skin, base.faces, base.vertex_bone)
    normals = vertex_normals(skin, base.faces)
    return Body(rig, skin, normals, base.faces, base.bone, base.weight, parts, base.vertex_bone, height_m)
