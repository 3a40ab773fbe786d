"""The operator's pixels: floor away, surfaces apart, then the one whose size is a person's and who was there before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from teleop.body.components import Surfaces, adjacency, grow_mask, label_surfaces, measure_surfaces
from teleop.body.floor import find_floor
from teleop.config.body import FloorConfig, SegmentationConfig
from teleop.frames import Camera, DepthFrame
from teleop.skeleton import FloorPlane


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A surface that may be the operator.

    mask: (H, W) bool. box: (u0, v0, u1, v1), ends excluded. area_px: pixels in the mask. centre_m: (3,) camera axes.
    """

    mask: npt.NDArray[np.bool_]
    box: tuple[int, int, int, int]
    area_px: int
    centre_m: npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """The decimated frame: grid step, depth in mm and m, points (h, w, 3) camera axes, labels of surfaces, floor."""

    step: int
    grid_mm: npt.NDArray[np.uint16]
    depth_m: npt.NDArray[np.float32]
    points_m: npt.NDArray[np.float32]
    labels: npt.NDArray[np.int32]
    surfaces: Surfaces
    floor: FloorPlane | None


def grid_points(depth_m: npt.NDArray[np.float32], step: int, camera: Camera) -> npt.NDArray[np.float32]:
    """Points (h, w, 3) of a grid that holds every step-th pixel."""
    k = camera.depth
    u = np.arange(depth_m.shape[1], dtype=np.float32) * step
    v = np.arange(depth_m.shape[0], dtype=np.float32) * step
    x = np.float32(camera.x_sign / k.fx) * (u - np.float32(k.cx)) * depth_m
    y = np.float32(-1.0 / k.fy) * (v - np.float32(k.cy))[:, None] * depth_m
    return np.stack([x, y, depth_m], axis=2)


def look(
    frame: DepthFrame, previous_floor: FloorPlane | None, floor_config: FloorConfig, config: SegmentationConfig
) -> Scene:
    """Decimate the frame, find the floor and part what stands on it into surfaces."""
    step = max(1, round(frame.camera.depth.width / config.grid_columns))
    grid_mm = np.ascontiguousarray(frame.depth_mm[::step, ::step])
    depth_m = grid_mm * np.float32(1e-3)
    points = grid_points(depth_m, step, frame.camera)
    usable = (depth_m > config.min_depth_m) & (depth_m < config.max_depth_m)
    floor = find_floor(points[usable], previous_floor, floor_config)
    levelled = points
    if floor is not None:
        R = floor.R_level_camera().astype(np.float32)
        levelled = points @ R.T
        levelled[..., 1] += np.float32(floor.camera_height_m)
        clearance = config.floor_clearance_m * np.maximum(1.0, 0.25 * depth_m * depth_m)
        usable &= levelled[..., 1] > clearance
    labels, count = label_surfaces(depth_m, usable, config.jump_m)
    cell_per_focal = step / frame.camera.depth.fx
    surfaces = measure_surfaces(labels, levelled, depth_m, count, cell_per_focal)
    return Scene(step, grid_mm, depth_m, points, labels, surfaces, floor)


def plausible(surfaces: Surfaces, config: SegmentationConfig) -> npt.NDArray[np.bool_]:
    """Which surfaces (C,) have a person's size."""
    extent = surfaces.high_m - surfaces.low_m
    return np.asarray(
        (surfaces.area_m2 >= config.min_area_m2)
        & (surfaces.area_m2 <= config.max_area_m2)
        & (extent[:, 1] >= config.min_height_m)
        & (extent[:, 1] <= config.max_height_m)
        & (extent[:, 0] <= config.max_width_m)
        & (extent[:, 2] <= config.max_thickness_m)
    )


def rank(scene: Scene, previous: npt.NDArray[np.bool_] | None, config: SegmentationConfig) -> list[int]:
    """Labels that may be the operator, likeliest first.

    previous: (h, w) the operator's cells of the last frame; overlap with them outweighs everything. Without it the
    nearest and most central person-sized surface comes first.
    """
    s = scene.surfaces
    fits = plausible(s, config)
    if not fits.any():
        return []
    overlap = np.zeros(len(s.cells))
    if previous is not None:
        labels = scene.labels[previous]
        overlap = np.bincount(labels[labels >= 0], minlength=len(s.cells)) / max(1, int(previous.sum()))
    distance = np.hypot(s.centre_m[:, 0], s.centre_m[:, 2])
    score = np.where(fits, 10.0 * overlap - distance - 0.5 * np.abs(s.centre_m[:, 0]), -np.inf)
    order = np.argsort(-score, kind="stable")[: config.candidates]
    return [int(k) for k in order if np.isfinite(score[k])]


def limbs_of(scene: Scene, main: int, config: SegmentationConfig) -> npt.NDArray[np.bool_]:
    """Which labels (C,) belong to the operator ``main``: it, and pieces its own arms or a table cut off it.

    A piece touches the operator's outline in the image and lies before it within an arm's reach, hardly behind it; it
    is small, or stands in line with it (crossed arms part the chest from the hips).
    """
    s = scene.surfaces
    touching = adjacency(scene.labels, main, len(s.cells), 4)
    nearer = s.centre_m[main, 2] - s.centre_m[:, 2]
    small = (s.area_m2 < 0.5 * s.area_m2[main]) & (s.cells >= 3)
    aligned = (np.abs(s.centre_m[:, 0] - s.centre_m[main, 0]) < 0.3) & (np.abs(nearer) < 0.3)
    bound = (touching > 0) & (touching >= 0.05 * s.cells)
    size = np.maximum(s.high_m[main], s.high_m) - np.minimum(s.low_m[main], s.low_m)
    limits = np.array([config.max_width_m, config.max_height_m, config.max_thickness_m])
    chosen = bound & (small | aligned) & (size <= limits).all(axis=1) & (nearer > -0.3) & (nearer < 0.9)
    chosen[main] = True
    return np.asarray(chosen)


def candidate(frame: DepthFrame, scene: Scene, label: int, config: SegmentationConfig) -> Candidate | None:
    """The full-resolution mask of one surface with its limbs; None when nothing of it is left."""
    members = limbs_of(scene, label, config)
    cells = (scene.labels >= 0) & members[scene.labels]
    mask = grow_mask(
        frame.depth_mm,
        cells,
        scene.grid_mm,
        scene.step,
        config.jump_m,
        _floor_row(scene.floor, frame.camera, config.floor_clearance_m),
    )
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    if len(rows) == 0:
        return None
    box = (int(columns[0]), int(rows[0]), int(columns[-1]) + 1, int(rows[-1]) + 1)
    centre = scene.points_m[cells].mean(axis=0, dtype=np.float64)
    return Candidate(mask, box, int(np.count_nonzero(mask)), centre)


def grid_mask(candidate_: Candidate, step: int) -> npt.NDArray[np.bool_]:
    """The candidate's cells (h, w), kept for the overlap with the next frame."""
    return np.ascontiguousarray(candidate_.mask[::step, ::step])


def _floor_row(floor: FloorPlane | None, camera: Camera, clearance_m: float) -> npt.NDArray[np.float64]:
    """Coefficients (a, b, c, e) of a pixel's height above the cut: ``z (a u + b v + c) + e``."""
    if floor is None:
        return np.array([0.0, 0.0, 0.0, 1.0])
    k, n = camera.depth, floor.normal
    a, b = n[0] * camera.x_sign / k.fx, -n[1] / k.fy
    return np.array([a, b, n[2] - a * k.cx - b * k.cy, floor.camera_height_m - clearance_m])
