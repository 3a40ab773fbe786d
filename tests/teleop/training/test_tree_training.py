"""Growing a tree on toy images: it separates, its leaves vote right, training and run time agree."""

import numpy as np
import pytest

from teleop.body.features import FAR_MM, body_pixels, pad_image
from teleop.body.forest import forest_leaves
from teleop.body.parts import MIRROR_PART, NO_PART
from teleop.frames import Camera, kinect_v1
from teleop.joints import MIRROR_JOINT
from teleop.training.build import join_trees
from teleop.training.fitting import image_of, logistic_weights
from teleop.training.images import Images, Pixels, draw_pixels
from teleop.training.leaves import fill_leaves, joint_offsets, tree_leaves
from teleop.training.trainer import Tree, TreeSpec, grow_tree

SPEC = TreeSpec(depth=8, candidates=60, sample=500, min_leaf=5)


def toy_images(count: int) -> Images:
    """Upright bars of three parts, head above trunk above hips, an arm to one side, at random places and depths."""
    rng = np.random.default_rng(0)
    camera = Camera(kinect_v1(160, 120), mirrored=True)
    flats, parts, rows, joints = [], [], [], []
    for _ in range(count):
        depth = np.zeros((120, 160), np.uint16)
        z, u, v = int(rng.integers(1800, 2600)), int(rng.integers(40, 90)), int(rng.integers(10, 30))
        s = 2000 / z
        head, trunk, end, wide, arm = (round(n * s) for n in (15, 40, 60, 12, 24))
        depth[v : v + end, u : u + wide] = z
        depth[v : v + head, u + 3 : u + wide - 3] = z - 60
        depth[v + head : v + head + 6, u : u + arm] = z
        image = pad_image(depth, depth > 0, (u, v, u + arm, v + end), camera, 0.5, 1)
        height, width = image.depth_mm.shape
        label = np.full((height, width), NO_PART, np.uint8)
        top = v - image.v0
        for part, low, high in ((0, 0, head), (4, head, trunk), (17, trunk, end)):
            band = slice(top + low, top + high)
            label[band] = np.where(image.depth_mm[band] < FAR_MM, part, NO_PART)
        flats.append(image.depth_mm.ravel())
        parts.append(label.ravel())
        rows.append((width, height, image.u0, image.v0, image.cx, image.cy, image.fx))
        u_m, v_m = u + wide / 2, v + head / 2
        centre = np.array([(u_m - image.cx) * z / image.fx, -(v_m - image.cy) * z / image.fy, z]) * 1e-3
        joints.append(np.tile(centre, (20, 1)))
    r = np.array(rows)
    sizes = (r[:, 0] * r[:, 1]).astype(np.int64)
    return Images(
        np.concatenate(flats),
        np.concatenate(parts),
        np.concatenate([[0], np.cumsum(sizes)[:-1]]),
        *(r[:, k].astype(np.int32) for k in range(4)),
        r[:, 4],
        r[:, 5],
        r[:, 6],
        np.array(joints),
        np.ones((count, 20), bool),
    )


def grown(images: Images, pixels: Pixels) -> Tree:
    tree = [t for _, t in grow_tree(images, pixels, SPEC, 7)][-1]
    assert tree is not None
    return tree


@pytest.fixture(scope="module")
def images() -> Images:
    return toy_images(40)


@pytest.fixture(scope="module")
def pixels(images: Images) -> Pixels:
    return draw_pixels(images, 80, np.random.default_rng(1), 0.5)


@pytest.fixture(scope="module")
def tree(images: Images, pixels: Pixels) -> Tree:
    return grown(images, pixels)


def test_parts_are_told_apart(images: Images, pixels: Pixels, tree: Tree) -> None:
    contents = fill_leaves(images, pixels, tree, 4)
    answer = contents.parts[tree_leaves(images, pixels, tree)].argmax(axis=1)
    assert (answer == pixels.part).mean() > 0.95


def test_votes_point_at_the_joint(images: Images, pixels: Pixels, tree: Tree) -> None:
    contents = fill_leaves(images, pixels, tree, 4)
    leaf = tree_leaves(images, pixels, tree)
    vote_m = contents.vote_mm[leaf, 0] * 1e-3
    offsets = joint_offsets(images, pixels)
    true = offsets[np.arange(len(leaf)), contents.vote_joint[leaf, 0]]
    error = np.median(np.linalg.norm(vote_m - true, axis=1))
    blind = np.median(np.linalg.norm(offsets[:, 0] - offsets[:, 0].mean(axis=0), axis=1))
    assert error < 0.4 * blind


def test_training_and_run_time_reach_the_same_leaves(images: Images, pixels: Pixels, tree: Tree) -> None:
    contents = fill_leaves(images, pixels, tree, 4)
    model = join_trees([tree], [contents], np.ones(19), {})
    for f in range(5):
        image = image_of(images, f)
        where = body_pixels(image.depth_mm, 1)
        width = image.depth_mm.shape[1]
        at = images.starts[f] + where[:, 0].astype(np.int64) * width + where[:, 1]
        trained = tree_leaves(images, Pixels(at, np.full(len(at), f, np.int32), np.zeros(len(at), np.uint8)), tree)
        assert (forest_leaves(model, image, where)[0] == trained).all()


def test_same_seed_same_tree(images: Images, pixels: Pixels, tree: Tree) -> None:
    again = grown(images, pixels)
    assert (again.offsets == tree.offsets).all()
    assert (again.children == tree.children).all()


def test_mirror_images_swap_sides(images: Images, pixels: Pixels) -> None:
    flipped = pixels.frame >= len(images)
    assert flipped.mean() == pytest.approx(0.5)
    assert set(pixels.part[flipped].tolist()) <= {MIRROR_PART[p] for p in (0, 4, 17)}
    offsets = joint_offsets(images, pixels)
    twin = Pixels(pixels.at, (pixels.frame + len(images)) % (2 * len(images)), pixels.part)
    other = joint_offsets(images, twin)
    np.testing.assert_allclose(other[:, list(MIRROR_JOINT)] * [-1, 1, 1], offsets, atol=1e-6)


def test_logistic_regression_separates() -> None:
    rng = np.random.default_rng(0)
    x = rng.normal(0, 1, (400, 3))
    labels = x[:, 0] + 0.5 * x[:, 1] > 0.2
    rows = np.concatenate([x, np.ones((400, 1))], axis=1)
    weights = logistic_weights(rows, labels, 0.1)
    assert ((rows @ weights > 0) == labels).mean() > 0.95
