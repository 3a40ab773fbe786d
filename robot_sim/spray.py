"""Spraying: a cone of parcels of droplets cast at the leaves, and how much of them is wet. Pure.

A leaf of area A hit by n parcels that wet an area a each is wet to the share 1 - exp(-n a / A): the parcels fall
independently (Poisson coverage).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from robot_sim.commands import Liquid
from robot_sim.config import SprayConfig
from robot_sim.primitives import Primitive, rotation

F64 = npt.NDArray[np.float64]
I64 = npt.NDArray[np.int64]
PAIRED_AREA = 0.75
"""The two boxes of a leaf overlap by about a quarter of their area; one side of a leaf counts."""
LIQUIDS: tuple[Liquid, ...] = tuple(Liquid)


@dataclass(frozen=True, slots=True, eq=False)
class Canopy:
    """L leaves made of P thin boxes.

    names, middle_m (L, 3), area_m2 (L,): the leaves. leaf (P,): which leaf a box belongs to; centre_m (P, 3),
    R (P, 3, 3) box to world, half_m (P, 3): the boxes.
    """

    names: tuple[str, ...]
    middle_m: F64
    area_m2: F64
    leaf: I64
    centre_m: F64
    R: F64
    half_m: F64


@dataclass(frozen=True, slots=True, eq=False)
class SprayState:
    """hits: (L, 3) parcels of each liquid on each leaf. missed: (3,) parcels that hit no leaf. tank_l: (3,) litres."""

    hits: I64
    missed: I64
    tank_l: tuple[float, float, float]


def canopy(parts: Sequence[Primitive]) -> Canopy:
    """The leaves of a greenhouse; a part named ``<leaf>_lobe`` or ``<leaf>_pair`` belongs to its leaf."""
    owner = [part.name.removesuffix("_lobe").removesuffix("_pair") for part in parts]
    names = tuple(dict.fromkeys(owner))
    leaf = np.array([names.index(name) for name in owner], dtype=np.int64)
    sizes = np.array([part.size_m for part in parts], dtype=np.float64).reshape(-1, 3)
    centre = np.array([part.xyz_m for part in parts], dtype=np.float64).reshape(-1, 3)
    count = np.bincount(leaf, minlength=len(names))
    area = np.bincount(leaf, weights=sizes[:, 0] * sizes[:, 1], minlength=len(names))
    return Canopy(
        names=names,
        middle_m=np.stack([np.bincount(leaf, weights=c, minlength=len(names)) for c in centre.T], axis=1)
        / count[:, None],
        area_m2=np.where(count > 1, PAIRED_AREA, 1.0) * area,
        leaf=leaf,
        centre_m=centre,
        R=np.array([rotation(part.rpy_rad) for part in parts], dtype=np.float64).reshape(-1, 3, 3),
        half_m=0.5 * sizes,
    )


def fresh(leaves: Canopy, config: SprayConfig) -> SprayState:
    """Dry leaves, full tanks."""
    full = (config.tank_l, config.tank_l, config.tank_l)
    return SprayState(np.zeros((len(leaves.names), 3), np.int64), np.zeros(3, np.int64), full)


def spray(
    state: SprayState,
    leaves: Canopy,
    liquid: Liquid,
    nozzle_m: F64,
    R_world_nozzle: F64,
    dt_s: float,
    rng: np.random.Generator,
    config: SprayConfig,
) -> SprayState:
    """Spray one liquid for ``dt_s`` seconds from a nozzle at (3,) along its -z; an empty tank gives nothing."""
    k = LIQUIDS.index(liquid)
    used = min(state.tank_l[k], config.flow_l_s * dt_s)
    if used <= 0.0:
        return state
    rate = config.parcels_1_s * used / config.flow_l_s
    n = int(rate) + int(rng.random() < rate - int(rate))
    tank = tuple(level - used if i == k else level for i, level in enumerate(state.tank_l))
    leaf = first_leaf(leaves, nozzle_m, cone(n, config.cone_rad, rng) @ R_world_nozzle.T, config.range_m)
    hits, missed = state.hits.copy(), state.missed.copy()
    np.add.at(hits[:, k], leaf[leaf >= 0], 1)
    missed[k] += int((leaf < 0).sum())
    return replace(state, hits=hits, missed=missed, tank_l=(tank[0], tank[1], tank[2]))


def cone(n: int, half_angle_rad: float, rng: np.random.Generator) -> F64:
    """(n, 3) unit vectors of a full cone about -z, evenly spread over a plane across it.

    Full-cone nozzles are built for an even distribution over the circle they wet, not over the solid angle.
    """
    radius = np.tan(half_angle_rad) * np.sqrt(rng.random(n))
    azimuth = 2.0 * np.pi * rng.random(n)
    rays = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), np.full(n, -1.0)], axis=1)
    return np.asarray(rays / np.linalg.norm(rays, axis=1, keepdims=True))


def first_leaf(leaves: Canopy, origin_m: F64, directions: F64, range_m: float) -> I64:
    """Number of the nearest leaf on each ray (n, 3) from ``origin_m`` (3,), -1 for none within ``range_m``."""
    if len(leaves.leaf) == 0:
        return np.full(len(directions), -1, np.int64)
    # slab test (Kay and Kajiya 1986) in every box's own axes: (P, n, 3)
    o = np.einsum("lji,lj->li", leaves.R, origin_m - leaves.centre_m)[:, None, :]
    d = np.einsum("lji,nj->lni", leaves.R, directions)
    d = np.where(np.abs(d) < 1e-12, 1e-12, d)
    half = leaves.half_m[:, None, :]
    a, b = (-half - o) / d, (half - o) / d
    near, far = np.minimum(a, b).max(axis=2), np.maximum(a, b).min(axis=2)
    distance = np.where((near <= far) & (far > 0.0) & (near <= range_m), near, np.inf)
    nearest = distance.argmin(axis=0)
    return np.where(np.isfinite(distance.min(axis=0)), leaves.leaf[nearest], -1)


def wet_share(state: SprayState, leaves: Canopy, config: SprayConfig) -> F64:
    """(L, 3) share of every leaf wet with each liquid, 0..1."""
    return np.asarray(1.0 - np.exp(-state.hits * config.parcel_m2 / leaves.area_m2[:, None]))


def missed_share(state: SprayState, liquid: Liquid | None = None) -> float:
    """Share 0..1 of what was sprayed (of one liquid, or of all) that hit no leaf; 0 when nothing was."""
    columns = slice(None) if liquid is None else slice(LIQUIDS.index(liquid), LIQUIDS.index(liquid) + 1)
    missed, hit = int(state.missed[columns].sum()), int(state.hits[:, columns].sum())
    return missed / (missed + hit) if missed + hit else 0.0


def wrong_share(state: SprayState, leaves: Canopy, diseased: frozenset[str]) -> float:
    """Share 0..1 of all parcels that hit a leaf which wants another liquid.

    diseased: plants that want pesticide and nothing else; all others want water or nutrient.
    """
    total = int(state.hits.sum() + state.missed.sum())
    ill = np.array([name.partition("_leaf_")[0] in diseased for name in leaves.names], dtype=bool)
    pesticide = state.hits[:, LIQUIDS.index(Liquid.PESTICIDE)]
    wrong = int(pesticide[~ill].sum() + (state.hits.sum(axis=1) - pesticide)[ill].sum())
    return wrong / total if total else 0.0


def coverage(
    state: SprayState, leaves: Canopy, liquid: Liquid, low_m: npt.ArrayLike, high_m: npt.ArrayLike, config: SprayConfig
) -> float:
    """Wet share, by area, of the leaves with their middle in the box ``low_m`` to ``high_m`` (3,); 0 without any."""
    inside = ((leaves.middle_m >= np.asarray(low_m)) & (leaves.middle_m <= np.asarray(high_m))).all(axis=1)
    area = leaves.area_m2[inside]
    if area.sum() == 0.0:
        return 0.0
    return float((wet_share(state, leaves, config)[inside, LIQUIDS.index(liquid)] * area).sum() / area.sum())
