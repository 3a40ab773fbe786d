"""Operators are cut out of rendered frames as the tracker cuts them, and shown to the networks with their truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from teleop.body.features import FAR_MM
from teleop.body.limbs import GROUPS
from teleop.body.parts import NO_PART
from teleop.config.body import BodyConfig
from teleop.data import data_root
from teleop.joints import JOINT_INDEX
from teleop.people.training_scenes import sample_scene
from teleop.training.bodies import Bodies, bodies_arrays, bodies_of, cut, joined
from teleop.training.dataset import Frames, Kind
from teleop.training.images import image_of, padded
from teleop.training.train_coarse import CoarseSpec
from teleop.training.train_coarse import draw as draw_whole
from teleop.training.train_finder import Grids
from teleop.training.train_finder import draw as draw_grids
from teleop.training.train_limbs import LimbSpec
from teleop.training.train_limbs import draw as draw_limbs

pytestmark = pytest.mark.skipif(data_root() is None, reason="rendered people need the data sets: TELEOP_DATA")
KINDS = (Kind.SCENE, Kind.NOBODY, Kind.SCENE, Kind.SCENE)


@pytest.fixture(scope="module")
def frames() -> Frames:
    shots = [
        sample_scene(seed, "validation", 320, 240, mirrored=seed % 2 == 1, nobody=kind is Kind.NOBODY)
        for seed, kind in enumerate(KINDS)
    ]
    return Frames(
        np.stack([s.frame.depth_mm for s in shots]),
        np.stack([s.part for s in shots]),
        np.stack([s.others for s in shots]),
        np.array(KINDS, np.uint8),
        np.array([s.frame.camera.mirrored for s in shots]),
        np.stack([s.joints_m for s in shots]),
        np.stack([s.visible for s in shots]),
    )


@pytest.fixture(scope="module")
def bodies(frames: Frames) -> Bodies:
    """Cut by the true masks: the frames are taken for people cut out."""
    depth = np.where(frames.part != NO_PART, frames.depth_mm, 0).astype(np.uint16)
    kind = np.where(frames.kind == Kind.NOBODY, Kind.NOBODY, Kind.CUT_OUT).astype(np.uint8)
    return cut(
        Frames(depth, frames.part, frames.others, kind, frames.mirrored, frames.joints_m, frames.visible),
        None,
        BodyConfig(),
    )


def test_frames_without_anybody_are_left_out_and_scenes_are_segmented(frames: Frames) -> None:
    found = cut(frames, None, BodyConfig())
    assert len(found) <= 3
    for f in range(len(found)):
        image = found.image(f)
        own = found.labels(f) != NO_PART
        assert (image[own] < FAR_MM).all()


def test_joints_lie_on_the_pixels_of_their_parts(bodies: Bodies) -> None:
    seen = 0
    for f in range(len(bodies)):
        pixels = bodies.pixels(f)
        part = bodies.labels(f).reshape(pixels.height, pixels.width)
        fx, fy, cx, cy = pixels.intrinsics
        for name in ("head", "spine", "shoulder_right", "shoulder_left"):
            j = JOINT_INDEX[name]
            if not bodies.visible[f, j]:
                continue
            x, y, z = bodies.joints_m[f, j]
            u, v = round(cx + fx * x / z), round(cy - fy * y / z)
            if 3 <= u < pixels.width - 3 and 3 <= v < pixels.height - 3:
                seen += 1
                assert (part[v - 3 : v + 4, u - 3 : u + 4] != NO_PART).any(), name
    assert seen >= 4


def test_padded_images_hold_the_same_pixels(bodies: Bodies) -> None:
    images = padded(bodies, 0.45)
    for f in range(len(bodies)):
        image, (width, height) = image_of(images, f), bodies.sizes[f]
        inner = image.depth_mm[-image.v0 : height - image.v0, -image.u0 : width - image.u0]
        assert (inner.reshape(-1) == bodies.image(f)).all()
        assert (image.depth_mm < FAR_MM).sum() == (bodies.image(f) < FAR_MM).sum()


def test_chunks_are_joined_and_their_labels_may_end_earlier(bodies: Bodies) -> None:
    twice = joined(iter([bodies, bodies]))
    assert len(twice) == 2 * len(bodies)
    assert (twice.image(len(bodies)) == bodies.image(0)).all()
    assert len(twice.labelled()) == len(twice)
    again = bodies_of(bodies_arrays(replace(twice, part=twice.part[:1])))
    assert len(again) == len(twice) and len(again.labelled()) == 1
    assert (again.image(len(bodies)) == bodies.image(0)).all() and (again.labels(0) == bodies.labels(0)).all()


def test_crops_point_back_to_the_true_joints(bodies: Bodies) -> None:
    rng = np.random.default_rng(0)
    before = bodies.joints_m + rng.normal(0, 0.02, bodies.joints_m.shape)
    spec = LimbSpec(shift_m=0.0, dropout=0.0)
    every = np.arange(len(bodies))
    for group, joints in enumerate(GROUPS):
        crops, poses, ways, seen, weights = draw_limbs(bodies, before, every, group, spec, rng)
        limbs = len(bodies) * len(joints)
        assert crops.shape == (limbs * 4, 32, 32, 2) and poses.shape == (limbs, 60)
        length = np.linalg.norm(ways, axis=2)
        true = np.linalg.norm((bodies.joints_m - before)[:, joints], axis=3).reshape(limbs, 4)
        assert length == pytest.approx(true, abs=1e-5)
        assert seen.shape == ways.shape and ((weights == 1.0) | (weights == np.float32(0.2))).all()


def test_half_of_the_whole_crops_are_mirrored_with_their_truth(bodies: Bodies) -> None:
    spec = CoarseSpec(shift_m=(0.0, 0.0, 0.0), dropout=0.0, cut=0.0)
    right, left = JOINT_INDEX["shoulder_right"], JOINT_INDEX["shoulder_left"]
    for seed in range(4):
        crops, places, _ = draw_whole(bodies, np.arange(len(bodies)), spec, np.random.default_rng(seed))
        assert crops.shape[1:] == (112, 96, 2)
        # canonical images run towards the operator's right, mirrored or not
        assert (places[:, right, 0] > places[:, left, 0]).all()


def test_grids_are_drawn_with_who_is_there(frames: Frames) -> None:
    thin = np.s_[:, ::2, ::2]
    grids = Grids(frames.depth_mm[thin].copy(), ((frames.part != NO_PART) | frames.others)[thin].copy())
    seen, person = draw_grids(grids, np.arange(4), np.random.default_rng(2))
    assert seen.shape == (4, 120, 160, 2) and person.shape == (4, 120, 160)
    assert not person[1].any() and person[0].any()
