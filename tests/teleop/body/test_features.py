"""The padded canonical image and the depth-difference sampler."""

import numpy as np
import pytest

from teleop.body.features import FAR_MM, body_pixels, body_points, depth_difference, pad_image, working_step
from teleop.frames import Camera, kinect_v1, points_m


def person_like(camera: Camera) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    depth = np.zeros((camera.depth.height, camera.depth.width), np.uint16)
    depth[60:200, 120:170] = rng.integers(1900, 2100, (140, 50))
    return depth, depth > 0


def box_of(mask: np.ndarray) -> tuple[int, int, int, int]:
    v, u = np.nonzero(mask)
    return int(u.min()), int(v.min()), int(u.max()) + 1, int(v.max()) + 1


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("step", [1, 2])
def test_points_of_the_canonical_image_are_those_of_the_frame(mirrored: bool, step: int) -> None:
    camera = Camera(kinect_v1(320, 240), mirrored)
    depth, mask = person_like(camera)
    image = pad_image(depth, mask, box_of(mask), camera, 0.45, step)
    found = body_points(image, body_pixels(image.depth_mm, 1))
    v, u = np.nonzero(mask & (np.indices(mask.shape) % step == 0).all(axis=0))
    expected = points_m(u, v, depth[v, u] * 1e-3, camera)
    order_a, order_b = np.lexsort(np.round(found, 4).T), np.lexsort(np.round(expected, 4).T)
    np.testing.assert_allclose(found[order_a], expected[order_b], atol=2e-4)


def test_padding_holds_the_largest_offset_at_the_nearest_pixel() -> None:
    camera = Camera(kinect_v1(320, 240))
    depth, mask = person_like(camera)
    depth[70, 130] = 900
    image = pad_image(depth, mask, box_of(mask), camera, 0.45, 1)
    reach = int(0.45 * camera.depth.fx / 0.9)
    where = body_pixels(image.depth_mm, 1)
    height, width = image.depth_mm.shape
    assert where.min() >= reach
    assert where[:, 0].max() + reach < height
    assert where[:, 1].max() + reach < width


def test_negative_scale_samples_the_mirrored_image_exactly() -> None:
    rng = np.random.default_rng(0)
    image = rng.integers(500, 4000, (81, 81)).astype(np.int16)
    mirror = np.ascontiguousarray(image[:, ::-1])
    for _ in range(500):
        offsets = rng.integers(-4000, 4001, (1, 4)).astype(np.int16)
        scale = np.float32(rng.uniform(0.001, 0.009))
        row, column = rng.integers(38, 43, 2)
        plain = depth_difference(image.ravel(), int(row * 81 + column), 81, -scale, scale, offsets, 0)
        flipped = depth_difference(mirror.ravel(), int(row * 81 + 80 - column), 81, scale, scale, offsets, 0)
        assert plain == flipped


def test_feature_off_the_body_reads_far() -> None:
    image = np.full((40, 40), FAR_MM, np.int16)
    image[18:22, 18:22] = 2000
    offsets = np.array([[1000, 0, 0, 0]], np.int16)
    assert depth_difference(image.ravel(), 20 * 40 + 20, 40, 0.01, 0.01, offsets, 0) == FAR_MM - 2000


def test_working_step_of_usual_cameras() -> None:
    assert working_step(Camera(kinect_v1(640, 480)), 285.63) == 2
    assert working_step(Camera(kinect_v1(320, 240)), 285.63) == 1
    assert working_step(Camera(kinect_v1(160, 120)), 285.63) == 1
