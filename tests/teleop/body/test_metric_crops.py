"""Metric crops: the same metres at every distance and resolution, relative depth, mirror images."""

from __future__ import annotations

import numpy as np
import pytest

from teleop.body.coarse import from_crop, to_crop, whole_crop
from teleop.body.crop import EMPTY, LOCAL, WHOLE, body_centre, joint_crops
from teleop.body.features import FAR_MM, Pixels
from teleop.joints import N_JOINTS

FOCAL_PX = 285.0


def pixels(image: np.ndarray, scale: int = 1) -> Pixels:
    """The image, enlarged, with the principal point in its middle."""
    large = np.repeat(np.repeat(image, scale, axis=0), scale, axis=1)
    height, width = large.shape
    intrinsics = np.array([FOCAL_PX * scale, FOCAL_PX * scale, (width - 1) / 2, (height - 1) / 2])
    return Pixels(np.ascontiguousarray(large).reshape(-1), 0, width, height, intrinsics)


def block_image(mm: int = 2000) -> np.ndarray:
    """A person-sized block in an empty image."""
    image = np.full((200, 120), FAR_MM, np.int16)
    image[20:180, 40:80] = mm
    return image


def crop_of(image: np.ndarray, depth_m: float, mirror: bool = False) -> np.ndarray:
    return whole_crop(pixels(image), (59.5, 99.5, depth_m), mirror)


def test_centre_is_the_median_of_the_body_at_every_resolution() -> None:
    column, row, depth_m = body_centre(pixels(block_image()))
    assert (column, row) == pytest.approx((59.5, 99.5), abs=1)
    assert depth_m == pytest.approx(2.0, abs=0.008)
    assert body_centre(pixels(block_image(), 3))[:2] == pytest.approx((179, 299), abs=3)


def test_crop_holds_the_same_metres_at_every_distance() -> None:
    near, far = crop_of(block_image(1500), 1.5), crop_of(block_image(3000), 3.0)
    ratio = float((far[..., 1] > 0).sum()) / float((near[..., 1] > 0).sum())
    assert ratio == pytest.approx(4.0, rel=0.1)  # the block of the far image is twice as wide and high


def test_crop_does_not_depend_on_the_resolution() -> None:
    fine = whole_crop(pixels(block_image(), 2), (119.5, 199.5, 2.0))
    assert np.abs(fine - whole_crop(pixels(block_image()), (59.5, 99.5, 2.0))).mean() < 0.02


def test_crop_tells_depth_relative_to_its_centre_and_marks_empty_cells() -> None:
    crop = crop_of(block_image(), 1.8)
    inside = crop[..., 1] > 0
    assert crop[inside, 0] == pytest.approx(0.2 / WHOLE.unit_m, abs=1e-3)
    assert (crop[~inside, 0] == EMPTY).all()


def test_mirrored_crop_is_the_crop_turned_about_its_centre() -> None:
    image = block_image()
    image[20:60, 80:100] = 1700  # an arm on one side
    plain, mirrored = crop_of(image, 2.0), crop_of(image, 2.0, mirror=True)
    # a sample at the very edge of a pixel may fall to either side of it
    assert np.abs(plain[:, ::-1, 1] - mirrored[..., 1]).mean() < 0.01


def test_places_in_the_crop_and_joints_are_inverse() -> None:
    rng = np.random.default_rng(0)
    joints = rng.normal(0, 0.5, (N_JOINTS, 3)) + np.array([0.1, 0.2, 2.4])
    centre, intrinsics = (70.0, 110.0, 2.3), np.array([285.0, 280.0, 60.0, 90.0])
    assert from_crop(to_crop(joints, centre, intrinsics), centre, intrinsics) == pytest.approx(joints, abs=1e-12)


def test_joint_crops_are_centred_on_the_joints() -> None:
    image = np.full((121, 121), FAR_MM, np.int16)
    image[58:63, 58:63] = 2000
    p = pixels(image)
    at, plain = np.array([[0.0, 0.0, 2.0]]), np.zeros(1, bool)
    crop = joint_crops(p.tuple(), at, plain, LOCAL.tuple())
    rows, columns = np.nonzero(crop[0, ..., 1])
    assert (rows.mean(), columns.mean()) == pytest.approx((15.5, 15.5), abs=1.0)
