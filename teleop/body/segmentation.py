"""The operator's pixels: floor and things away, surfaces apart, then the one of a person's size seen there before."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass

import numba as nb
import numpy as np
import numpy.typing as npt

from teleop.body.beside import later
from teleop.body.components import Surfaces, adjacency, label_surfaces, measure_surfaces
from teleop.body.finder import Finder, person_cells
from teleop.body.floor import find_floor
from teleop.body.grid import Grid, Window, cloud, decimate, standing
from teleop.body.mask import grow_mask
from teleop.config.body import FloorConfig, SegmentationConfig
from teleop.frames import Camera, DepthFrame
from teleop.skeleton import FloorPlane

_NO_CELLS = np.zeros((0, 0), np.bool_)


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A surface that may be the operator.

    mask: (H, W) bool. box: (u0, v0, u1, v1), ends excluded. area_px: pixels in the mask. centre_m: (3,) camera axes.
    person: mean probability that its cells show a person, 1 without a finder.
    """

    mask: npt.NDArray[np.bool_]
    box: tuple[int, int, int, int]
    area_px: int
    centre_m: npt.NDArray[np.float64]
    person: float


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """The decimated frame, probability of each cell (h, w) to show a person (None without a finder), labels (h, w) of
    surfaces, their figures, floor."""

    grid: Grid
    person: npt.NDArray[np.float32] | None
    labels: npt.NDArray[np.int32]
    surfaces: Surfaces
    floor: FloorPlane | None


def look(
    frame: DepthFrame,
    previous_floor: FloorPlane | None,
    finder: Finder | None,
    floor_config: FloorConfig,
    config: SegmentationConfig,
    beside: Executor | None = None,
    window: Window | None = None,
) -> Scene:
    """Decimate the frame, find the floor and people's cells, and part what is left into surfaces.

    beside: where the floor is found, while the finder runs here. window: where alone people are looked for.
    """
    grid = decimate(frame, config.grid_columns)
    ground = later(None if finder is None else beside, _ground, grid, previous_floor, floor_config, config)
    person = None if finder is None else person_cells(finder, grid.depth_mm, window)
    floor, usable, levelled = ground()
    if person is not None:
        usable &= person > config.min_person
    labels, count = label_surfaces(grid.depth_mm, usable, config.jump_m)
    cell_per_focal = grid.step / frame.camera.depth.fx
    surfaces = measure_surfaces(labels, levelled, grid.depth_mm, person, count, cell_per_focal)
    return Scene(grid, person, labels, surfaces, floor)


def _ground(
    grid: Grid, previous: FloorPlane | None, floor_config: FloorConfig, config: SegmentationConfig
) -> tuple[FloorPlane | None, npt.NDArray[np.bool_], npt.NDArray[np.float32]]:
    """The floor, and what stands on it, see standing."""
    near_m, far_m = config.min_depth_m, config.max_depth_m
    floor = find_floor(*cloud(grid, near_m, far_m), previous, floor_config)
    return floor, *standing(grid, near_m, far_m, floor, config.floor_clearance_m)


def window_round(
    cells: npt.NDArray[np.bool_], depth_m: float, dt_s: float, camera: Camera, config: SegmentationConfig
) -> Window | None:
    """The part of the grid that an operator can have reached in ``dt_s`` who was in cells (h, w) at a depth; None where
    there are none."""
    rows, columns = np.flatnonzero(cells.any(axis=1)), np.flatnonzero(cells.any(axis=0))
    if len(rows) == 0:
        return None
    step = max(1, round(camera.depth.width / config.grid_columns))
    reach_m = config.window_m + config.window_m_s * dt_s
    margin = int(reach_m * camera.depth.fx / step / max(depth_m, config.min_depth_m)) + 1
    height, width = cells.shape
    return (
        max(0, int(rows[0]) - margin),
        max(0, int(columns[0]) - margin),
        min(height, int(rows[-1]) + 1 + margin),
        min(width, int(columns[-1]) + 1 + margin),
    )


@nb.njit(cache=True, nogil=True)
def _overlap(labels: npt.NDArray[np.int32], cells: npt.NDArray[np.bool_], count: int) -> npt.NDArray[np.float64]:
    """Share (C,) of the cells (h, w) that each label covers; none without cells."""
    out, total = np.zeros(count), 0
    for r in range(cells.shape[0]):
        for c in range(cells.shape[1]):
            if cells[r, c]:
                total += 1
                if labels[r, c] >= 0:
                    out[labels[r, c]] += 1.0
    return out / max(1, total)


@nb.njit(cache=True, nogil=True)
def _scores(
    overlap: npt.NDArray[np.float64],
    area_m2: npt.NDArray[np.float64],
    low_m: npt.NDArray[np.float64],
    high_m: npt.NDArray[np.float64],
    centre_m: npt.NDArray[np.float64],
    smallest: tuple[float, float],
    largest: tuple[float, float, float, float],
) -> npt.NDArray[np.float64]:
    """How likely each surface (C,) is the operator, -inf without a person's size. smallest: area [m2] and height [m].
    largest: area, width, height, thickness."""
    out = np.full(len(area_m2), -np.inf)
    for k in range(len(area_m2)):
        wide, high, thick = high_m[k] - low_m[k]
        fits = smallest[0] <= area_m2[k] <= largest[0] and smallest[1] <= high <= largest[2]
        if fits and wide <= largest[1] and thick <= largest[3]:
            x, z = centre_m[k, 0], centre_m[k, 2]
            out[k] = 10.0 * overlap[k] - np.hypot(x, z) - 0.5 * abs(x)
    return out


def rank(scene: Scene, previous: npt.NDArray[np.bool_] | None, config: SegmentationConfig) -> list[int]:
    """Labels that may be the operator, likeliest first.

    previous: (h, w) the operator's cells of the last frame; overlap with them outweighs everything. Without it the
    nearest and most central person-sized surface comes first.
    """
    s = scene.surfaces
    overlap = _overlap(scene.labels, _NO_CELLS if previous is None else previous, len(s.cells))
    smallest = (config.min_area_m2, config.min_height_m)
    largest = (config.max_area_m2, config.max_width_m, config.max_height_m, config.max_thickness_m)
    score = _scores(overlap, s.area_m2, s.low_m, s.high_m, s.centre_m, smallest, largest)
    order = np.argsort(-score, kind="stable")[: config.candidates]
    return [k for k in order.tolist() if score[k] > -np.inf]


@nb.njit(cache=True, nogil=True)
def _bound_to(
    main: int,
    touching: npt.NDArray[np.int32],
    cells: npt.NDArray[np.int64],
    area_m2: npt.NDArray[np.float64],
    centre_m: npt.NDArray[np.float64],
    low_m: npt.NDArray[np.float64],
    high_m: npt.NDArray[np.float64],
    largest_m: tuple[float, float, float],
) -> npt.NDArray[np.bool_]:
    chosen = np.zeros(len(cells), np.bool_)
    for k in range(len(cells)):
        if touching[k] <= 0 or touching[k] < 0.05 * cells[k]:
            continue
        nearer = centre_m[main, 2] - centre_m[k, 2]
        small = area_m2[k] < 0.5 * area_m2[main] and cells[k] >= 3
        aligned = abs(centre_m[k, 0] - centre_m[main, 0]) < 0.3 and abs(nearer) < 0.3
        fits = -0.3 < nearer < 0.9
        for axis in range(3):
            size_m = max(high_m[main, axis], high_m[k, axis]) - min(low_m[main, axis], low_m[k, axis])
            fits &= size_m <= largest_m[axis]
        chosen[k] = fits and (small or aligned)
    chosen[main] = True
    return chosen


def limbs_of(scene: Scene, main: int, config: SegmentationConfig) -> npt.NDArray[np.bool_]:
    """Which labels (C,) belong to the operator ``main``: it, and pieces its own arms or a table cut off it.

    A piece touches the operator's outline in the image and lies before it within an arm's reach, hardly behind it; it
    is small, or stands in line with it (crossed arms part the chest from the hips).
    """
    s = scene.surfaces
    touching = adjacency(scene.labels, main, len(s.cells), 4)
    largest_m = (config.max_width_m, config.max_height_m, config.max_thickness_m)
    chosen = _bound_to(main, touching, s.cells, s.area_m2, s.centre_m, s.low_m, s.high_m, largest_m)
    return np.asarray(chosen)


def candidate(frame: DepthFrame, scene: Scene, label: int, config: SegmentationConfig) -> Candidate | None:
    """The full-resolution mask of one surface with its limbs; None when nothing of it is left."""
    members, s, floor = limbs_of(scene, label, config), scene.surfaces, scene.floor
    mask, area_px, box = grow_mask(
        frame.depth_mm,
        scene.labels,
        members,
        scene.grid.depth_mm,
        scene.grid.step,
        config.jump_m,
        _floor_row(floor, frame.camera, config.floor_clearance_m),
    )
    if area_px == 0:
        return None
    share = np.where(members, s.cells, 0) / s.cells[members].sum()
    centre = share @ s.centre_m
    if floor is not None:
        centre = floor.R_level_camera().T @ (centre - np.array([0.0, floor.camera_height_m, 0.0]))
    return Candidate(mask, box, area_px, centre, float(share @ s.person))


def grid_mask(candidate_: Candidate, step: int) -> npt.NDArray[np.bool_]:
    """The candidate's cells (h, w), kept for the overlap with the next frame."""
    return np.ascontiguousarray(candidate_.mask[::step, ::step])


def _floor_row(floor: FloorPlane | None, camera: Camera, clearance_m: float) -> npt.NDArray[np.float32]:
    """Coefficients (a, b, c, e) of a pixel's height above the cut: ``z (a u + b v + c) + e``."""
    if floor is None:
        return np.array([0.0, 0.0, 0.0, 1.0], np.float32)
    k, n = camera.depth, floor.normal
    a, b = n[0] * camera.x_sign / k.fx, -n[1] / k.fy
    return np.array([a, b, n[2] - a * k.cx - b * k.cy, floor.camera_height_m - clearance_m], np.float32)
