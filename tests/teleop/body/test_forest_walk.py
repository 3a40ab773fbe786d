"""The interleaved walk against a plain one, pixel by pixel."""

import numpy as np

from teleop.body.features import body_pixels, depth_difference, pad_image
from teleop.body.forest import forest_leaves, mean_parts, offset_unit, stride_for
from teleop.body.model import load_model
from teleop.frames import Camera, kinect_v1


def test_walk_reaches_the_leaves_of_a_plain_descent() -> None:
    model = load_model()
    rng = np.random.default_rng(1)
    camera = Camera(kinect_v1(320, 240))
    depth = np.zeros((240, 320), np.uint16)
    depth[60:200, 120:170] = rng.integers(1900, 2400, (140, 50))
    mask = depth > 0
    image = pad_image(depth, mask, (120, 60, 170, 200), camera, model.max_offset_m, 1)
    where = body_pixels(image.depth_mm, 7)
    found = forest_leaves(model, image, where)
    flat, width = image.depth_mm.ravel(), image.depth_mm.shape[1]
    unit = np.float32(offset_unit(image.fx))
    for tree, root in enumerate(model.roots):
        for n, (row, column) in enumerate(where):
            at = int(row) * width + int(column)
            scale = unit / np.float32(flat[at])
            node = int(root)
            while model.leaves[node] < 0:
                value = depth_difference(flat, at, width, scale, scale, model.offsets, node)
                node = int(model.children[node]) + int(value >= model.thresholds_mm[node])
            assert found[tree, n] == model.leaves[node]


def test_part_probabilities_are_the_mean_over_the_trees() -> None:
    leaf_parts = np.array([[255, 0], [0, 255], [128, 127]], np.uint8)
    out = mean_parts(np.array([[0, 2], [1, 2]], np.int32), leaf_parts)
    np.testing.assert_allclose(out, [[0.5, 0.5], [128 / 255, 127 / 255]], atol=1e-6)


def test_stride_keeps_the_pixels_within_the_budget() -> None:
    assert stride_for(4000, 4500) == 1
    for area in (5000, 25_000, 100_000):
        assert area / stride_for(area, 4500) ** 2 <= 4500
