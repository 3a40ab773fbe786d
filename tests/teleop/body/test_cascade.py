"""Crops and what the networks make of them: geometry, symmetry, second opinions, the model file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from teleop.body.cascade import NEAREST_M, Cascade, Placed, see, settle
from teleop.body.coarse import from_crop, to_crop
from teleop.body.crop import EMPTY, LOCAL, WHOLE, body_centre, crop_cells
from teleop.body.features import FAR_MM, PaddedImage
from teleop.body.model import load_model, save_model
from teleop.body.refine import IS_LEFT, NEAR, joint_crops, near_vectors
from teleop.config.body import CascadeConfig
from teleop.errors import ModelError
from teleop.joints import MIRROR_JOINT, N_JOINTS

FOCAL_PX = 285.0


def block_image(mm: int = 2000) -> np.ndarray:
    """A person-sized block in an empty image."""
    image = np.full((200, 120), FAR_MM, np.int16)
    image[20:180, 40:80] = mm
    return image


def crop_of(image: np.ndarray, column: float, row: float, depth_m: float, mirror: bool = False) -> np.ndarray:
    height, width = image.shape
    return crop_cells(
        image.reshape(-1),
        0,
        width,
        height,
        column,
        row,
        depth_m,
        FOCAL_PX,
        FOCAL_PX,
        mirror,
        WHOLE.rows,
        WHOLE.columns,
        WHOLE.cell_m,
        WHOLE.unit_m,
        WHOLE.near,
        WHOLE.far,
    )


def test_centre_is_the_median_of_the_body() -> None:
    column, row, depth_m = body_centre(block_image().reshape(-1), 0, 120, 200)
    assert (column, row) == (60.0, 100.0)
    assert depth_m == pytest.approx(2.0, abs=0.008)


def test_crop_holds_the_same_metres_at_every_distance() -> None:
    near, far = crop_of(block_image(1500), 60, 100, 1.5), crop_of(block_image(3000), 60, 100, 3.0)
    ratio = float((far[..., 1] > 0).sum()) / float((near[..., 1] > 0).sum())
    assert ratio == pytest.approx(4.0, rel=0.1)  # the block of the far image is twice as wide and high


def test_crop_tells_depth_relative_to_its_centre_and_marks_empty_cells() -> None:
    crop = crop_of(block_image(), 60, 100, 1.8)
    inside = crop[..., 1] > 0
    assert crop[inside, 0] == pytest.approx(0.2 / WHOLE.unit_m, abs=1e-3)
    assert (crop[~inside, 0] == EMPTY).all()


def test_mirrored_crop_is_the_crop_turned_about_its_centre() -> None:
    image = block_image()
    image[20:60, 80:100] = 1700  # an arm on one side
    plain, mirrored = crop_of(image, 60.0, 100.0, 2.0), crop_of(image, 60.0, 100.0, 2.0, mirror=True)
    # a pixel's column at the very edge of a cell may fall to either side of it
    assert np.abs(plain[:, ::-1, 1] - mirrored[..., 1]).mean() < 0.01


def test_places_in_the_crop_and_joints_are_inverse() -> None:
    rng = np.random.default_rng(0)
    joints = rng.normal(0, 0.5, (N_JOINTS, 3)) + np.array([0.1, 0.2, 2.4])
    centre, intrinsics = (70.0, 110.0, 2.3), np.array([285.0, 280.0, 60.0, 90.0])
    assert from_crop(to_crop(joints, centre, intrinsics), centre, intrinsics) == pytest.approx(joints, abs=1e-12)


def test_both_sides_of_the_body_look_alike_to_the_refiner() -> None:
    rng = np.random.default_rng(1)
    joints = rng.normal(0, 0.3, (N_JOINTS, 3)) + np.array([0.0, 0.0, 2.0])
    mirror = joints[list(MIRROR_JOINT)] * [-1.0, 1.0, 1.0]
    left = np.flatnonzero(IS_LEFT)
    right = np.array(MIRROR_JOINT)[left]
    assert near_vectors(joints)[left] == pytest.approx(near_vectors(mirror)[right], abs=1e-6)
    assert (np.array(MIRROR_JOINT)[NEAR[left]] == NEAR[right]).all()


def test_joint_crops_are_centred_on_the_joints() -> None:
    image = np.full((120, 120), FAR_MM, np.int16)
    image[58:63, 58:63] = 2000
    shape = (LOCAL.rows, LOCAL.columns, LOCAL.cell_m, LOCAL.unit_m, LOCAL.near, LOCAL.far)
    intrinsics = np.array([FOCAL_PX, FOCAL_PX, 60.0, 60.0])
    crop = joint_crops(
        image.reshape(-1), 0, 120, 120, intrinsics, np.array([[0.0, 0.0, 2.0]]), np.zeros(1, bool), shape
    )
    rows, columns = np.nonzero(crop[0, ..., 1])
    assert (rows.mean(), columns.mean()) == pytest.approx((15.5, 15.5), abs=1.0)


def padded() -> PaddedImage:
    return PaddedImage(block_image(), -60, -100, FOCAL_PX, FOCAL_PX, 0.0, 0.0)


def place(cascade: Cascade, image: PaddedImage, forest_m: np.ndarray, config: CascadeConfig) -> Placed:
    return settle(cascade, see(cascade, image, config), forest_m, config)


def test_every_joint_is_placed_with_cues_and_the_forest_is_heard() -> None:
    cascade = load_model().cascade
    assert cascade is not None
    config = CascadeConfig(opinion_ratio=1.0)
    alone = place(cascade, padded(), np.full((N_JOINTS, 3), np.nan), config)
    assert np.isfinite(alone.joints_m).all()
    assert np.isfinite(alone.cues).all()
    assert (alone.joints_m[:, 2] > NEAREST_M).all()
    elsewhere = alone.joints_m + np.array([0.0, 0.15, 0.0])
    heard = place(cascade, padded(), elsewhere, config)
    assert not np.array_equal(heard.joints_m, alone.joints_m)
    deaf = place(cascade, padded(), elsewhere, CascadeConfig(opinion_ratio=0.0))
    assert np.array_equal(deaf.joints_m, alone.joints_m)


def test_networks_come_back_from_a_file_as_they_were(tmp_path: Path) -> None:
    model = load_model()
    save_model(model, tmp_path / "model.npz")
    again = load_model(tmp_path / "model.npz")
    unknown = np.full((N_JOINTS, 3), np.nan)
    assert model.cascade is not None
    assert again.cascade is not None
    found = [place(c, padded(), unknown, CascadeConfig()).joints_m for c in (model.cascade, again.cascade)]
    assert np.array_equal(*found)


def test_networks_that_do_not_fit_together_are_refused(tmp_path: Path) -> None:
    model = load_model()
    assert model.cascade is not None
    broken = replace(model.cascade.coarse, head=model.cascade.coarse.head[:-1])
    save_model(replace(model, cascade=replace(model.cascade, coarse=broken)), tmp_path / "broken.npz")
    with pytest.raises(ModelError, match="coarse_head"):
        load_model(tmp_path / "broken.npz")
