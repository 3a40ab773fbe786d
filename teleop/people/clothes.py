"""Clothes, shoes and hair as displaced, coloured skin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from teleop.people.body import Body, Bytes, Floats32
from teleop.people.rig import BONE, FINGERS, SIDES, Floats

_SHIRT_HEM = 0.15
"""A top that reaches less far down the thigh ends above the hips instead."""


@dataclass(frozen=True, slots=True, eq=False)
class Dressed:
    """A body in clothes: rest vertices (V, 3) float32 and their colours (V, 3) uint8 RGB, unlit."""

    vertices_m: Floats32
    color_rgb: Bytes


@dataclass(frozen=True, slots=True)
class Wardrobe:
    """What a person wears; thicknesses in metres, lengths along the limb (1 elbow or knee, 2 wrist or ankle)."""

    top_m: float
    sleeve_m: float
    sleeve_length: float
    hem_length: float
    trousers_m: float
    trousers_length: float
    shoes_m: float
    hair_m: float
    hair_length: float
    fold: float
    cap: bool
    top_rgb: tuple[int, int, int]
    trousers_rgb: tuple[int, int, int]
    shoes_rgb: tuple[int, int, int]
    hair_rgb: tuple[int, int, int]
    skin_rgb: tuple[int, int, int]
    gloves_rgb: tuple[int, int, int] | None = None
    gloves_m: float = 0.0


def skin_tone(rng: np.random.Generator) -> tuple[int, int, int]:
    """A skin colour between very light and very dark; Cb and Cr stay where real skin's are (Chai and Ngan 1999)."""
    t = rng.uniform()
    light, dark = np.array([238.0, 198.0, 172.0]), np.array([84.0, 52.0, 36.0])
    rgb = light * (1 - t) + dark * t + rng.normal(0, 4.0, 3)
    r, g, b = (int(v) for v in np.clip(rgb, 20, 250))
    return r, g, b


def cloth_rgb(rng: np.random.Generator) -> tuple[int, int, int]:
    """Any colour that cloth has, pale ones more often than bright ones."""
    value, saturation = rng.uniform(25, 235), rng.uniform(0, 0.8) ** 1.5
    tint = rng.uniform(0, 1, 3)
    tint /= tint.max()
    r, g, b = (int(v) for v in np.clip(value * (1 - saturation + saturation * tint), 5, 250))
    return r, g, b


def random_wardrobe(rng: np.random.Generator) -> Wardrobe:
    """Tight to loose, short to long, coats, shorts, caps, bald to big hair."""
    coat = rng.uniform() < 0.2
    loose = rng.uniform() ** 1.6
    top = rng.uniform(0.015, 0.04) if coat else 0.003 + 0.022 * loose
    long_sleeves = coat or rng.uniform() < 0.5
    hair = rng.choice([0.002, 0.012, 0.025, 0.045], p=[0.15, 0.4, 0.3, 0.15])
    return Wardrobe(
        top_m=float(top),
        sleeve_m=float(top * rng.uniform(0.5, 0.9)),
        sleeve_length=float(rng.uniform(1.7, 1.98) if long_sleeves else rng.uniform(0.15, 0.95)),
        hem_length=float(rng.uniform(0.3, 0.9) if coat else rng.uniform(-0.05, 0.2)),
        trousers_m=float(0.003 + 0.022 * rng.uniform() ** 1.6),
        trousers_length=float(rng.uniform(0.6, 1.1) if rng.uniform() < 0.15 else rng.uniform(1.8, 2.0)),
        shoes_m=float(rng.uniform(0.003, 0.012)),
        hair_m=float(hair * rng.uniform(0.8, 1.3)),
        hair_length=float(rng.uniform(0.0, 1.0) ** 2),
        fold=float(rng.uniform(0.1, 0.6)),
        cap=bool(rng.uniform() < 0.12),
        top_rgb=cloth_rgb(rng),
        trousers_rgb=cloth_rgb(rng),
        shoes_rgb=cloth_rgb(rng),
        hair_rgb=tuple(int(v) for v in rng.uniform(0.3, 1.0) * np.array([150, 110, 75]) * rng.uniform(0.15, 1.0)),  # type: ignore[arg-type]
        skin_rgb=skin_tone(rng),
    )


def _along(points: Floats, a: Floats, b: Floats, c: Floats) -> Floats:
    """0 at a, 1 at b, 2 at c, for points along a bent limb."""
    first = (points - a) @ (b - a) / ((b - a) @ (b - a))
    second = (points - b) @ (c - b) / ((c - b) @ (c - b))
    return np.where(first < 1.0, first, 1.0 + np.maximum(second, 0.0))


def _folds(points: Floats, rng: np.random.Generator) -> Floats:
    """Smooth noise (V,) of about unit amplitude with wavelengths of 6 to 40 cm."""
    k = rng.normal(0, 1, (5, 3))
    k *= (2 * np.pi / rng.uniform(0.06, 0.4, 5) / np.linalg.norm(k, axis=1))[:, None]
    phase = rng.uniform(0, 2 * np.pi, 5)
    return np.sin(points @ k.T + phase).sum(axis=1) / np.sqrt(2.5)


def _ramp(x: Floats, soft: float) -> Floats:
    return np.clip(x / soft, 0.0, 1.0)


def dress(body: Body, wear: Wardrobe, seed: int) -> Dressed:
    """Dress a body; the seed sets the folds. Sleeves, hems and hair end in short ramps, so that edges show."""
    rng = np.random.default_rng(seed)
    rig, points = body.rig, body.vertices_m.astype(np.float64)
    n = len(points)
    cover, color = np.zeros(n), np.tile(np.array(wear.skin_rgb, np.uint8), (n, 1))
    bone = body.vertex_bone

    def on(*names: str) -> npt.NDArray[np.bool_]:
        return np.isin(bone, [BONE[name] for name in names])

    hips_y = 0.5 * (rig.bone("thigh_right")[1] + rig.bone("thigh_left")[1])
    neck_y = rig.neck_base_m[1]
    for side in SIDES:
        hip, knee, ankle = (rig.bone(f"{b}_{side}") for b in ("thigh", "shin", "foot"))
        leg = on(f"thigh_{side}", f"shin_{side}")
        s = _along(points, hip, knee, ankle)
        worn = leg & (s < wear.trousers_length)
        cover[worn] = (wear.trousers_m * _ramp(wear.trousers_length - s, 0.06))[worn]
        color[worn] = wear.trousers_rgb
        hem = leg & (s < wear.hem_length) & (wear.hem_length > _SHIRT_HEM)
        cover[hem] = np.maximum(cover, wear.top_m * _ramp(wear.hem_length - s, 0.05))[hem]
        color[hem] = wear.top_rgb
        foot = on(f"foot_{side}", f"toes_{side}")
        cover[foot], color[foot] = wear.shoes_m, wear.shoes_rgb
        shoulder, elbow, wrist = (rig.bone(f"{b}_{side}") for b in ("upper_arm", "forearm", "hand"))
        arm = on(f"upper_arm_{side}", f"upper_arm_twist_{side}", f"forearm_{side}", f"forearm_twist_{side}")
        s = _along(points, shoulder, elbow, wrist)
        worn = arm & (s < wear.sleeve_length)
        blend = np.clip(s / 0.5, 0.0, 1.0)
        thick = wear.top_m * (1 - blend) + wear.sleeve_m * blend
        cover[worn] = (thick * _ramp(wear.sleeve_length - s, 0.05))[worn]
        color[worn] = wear.top_rgb
    torso = on("pelvis", "spine", "chest", "clavicle_right", "clavicle_left")
    hem_y = hips_y + (0.06 if wear.hem_length <= _SHIRT_HEM else -0.3)
    shirt = torso & (points[:, 1] > hem_y)
    cover[torso], color[torso] = wear.trousers_m, wear.trousers_rgb
    cover[shirt] = (wear.top_m * _ramp(neck_y + 0.03 - points[:, 1], 0.04))[shirt]
    color[shirt & (points[:, 1] < neck_y + 0.02)] = wear.top_rgb
    color[shirt & (points[:, 1] >= neck_y + 0.02)] = wear.skin_rgb
    cover *= 1.0 + wear.fold * _folds(points, rng)
    _hair(body, wear, points, cover, color)
    _hands(body, wear, cover, color)
    out = body.vertices_m + (np.maximum(cover, 0.0)[:, None] * body.normals).astype(np.float32)
    return Dressed(out.astype(np.float32), color)


def _hair(body: Body, wear: Wardrobe, points: Floats, cover: Floats, color: Bytes) -> None:
    head = np.isin(body.vertex_bone, [BONE["head"], BONE["neck"]])
    d = points - body.rig.skull_m
    # Skin from the brows down in front of the ears; behind them the hair reaches down to the chin or the neck.
    behind = d[:, 2] - 0.015
    above = d[:, 1] - np.where(behind < 0, 0.045, -0.03 - 0.14 * wear.hair_length - 0.4 * behind)
    if wear.cap:
        above = d[:, 1] - 0.02
    hair = head & (above > 0)
    cover[hair] = ((0.018 if wear.cap else wear.hair_m) * _ramp(above, 0.03))[hair]
    color[hair] = wear.top_rgb if wear.cap else wear.hair_rgb


def _hands(body: Body, wear: Wardrobe, cover: Floats, color: Bytes) -> None:
    """Gloves; or palms and the inside of the fingers: with little pigment, so lighter and redder than dark skin is."""
    skin = np.array(wear.skin_rgb, np.float64)
    share = 0.10 + 0.55 * float(np.clip(1.0 - skin.mean() / 195.0, 0.0, 1.0))
    palm_rgb = skin + share * (np.array([226.0, 172.0, 152.0]) - skin)
    for i, side in enumerate(SIDES):
        bones = [BONE[f"hand_{side}"], *(BONE[f"{finger}{k}_{side}"] for finger in FINGERS for k in (1, 2, 3))]
        mine = np.isin(body.vertex_bone, bones)
        if wear.gloves_rgb is not None:
            cover[mine], color[mine] = wear.gloves_m, wear.gloves_rgb
            continue
        facing = body.normals[mine].astype(np.float64) @ body.rig.palm[i]
        blend = np.clip((facing - 0.1) / 0.5, 0.0, 1.0)[:, None]
        color[mine] = np.clip(skin + blend * (palm_rgb - skin), 0, 255).astype(np.uint8)
