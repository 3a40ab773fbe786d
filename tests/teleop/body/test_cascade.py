"""What the networks make of a person's image: geometry, symmetry, rounds, the model file."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from teleop.body.cascade import Cascade, Placed, begin, settle
from teleop.body.features import Pixels, operator_pixels
from teleop.body.limbs import ARMS, GROUPS, LEFT_ARM, LEGS, RIGHT_ARM, SWAPPED, TRUNK, place, pose_vectors
from teleop.body.model import load_model, save_model
from teleop.errors import ModelError
from teleop.frames import Camera, DepthFrame
from teleop.joints import JOINT_INDEX, N_JOINTS
from teleop.sources.virtual import open_virtual

UNKNOWN = np.full((N_JOINTS, 3), np.nan)
ROUNDS = 2


@pytest.fixture(scope="module")
def cascade() -> Cascade:
    found = load_model().cascade
    assert found is not None
    return found


@pytest.fixture(scope="module")
def person() -> tuple[Pixels, np.ndarray]:
    """The built-in body cut out of its room by its true parts, and its joints."""
    shot = open_virtual("builtin,fps=15").performance.take(60)
    frame: DepthFrame = shot.frame
    near = np.abs(frame.depth_mm.astype(float) - 1000 * shot.joints_m[JOINT_INDEX["spine"], 2]) < 500
    k = frame.camera.depth
    u, _ = np.meshgrid(np.arange(k.width), np.arange(k.height))
    middle = k.cx + frame.camera.x_sign * k.fx * shot.joints_m[0, 0] / shot.joints_m[0, 2]
    mask = near & (np.abs(u - middle) < 0.5 * k.fx / shot.joints_m[0, 2])
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    box = (int(columns[0]), int(rows[0]), int(columns[-1]) + 1, int(rows[-1]) + 1)
    return operator_pixels(frame.depth_mm, mask, box, frame.camera), shot.joints_m


def placed(cascade: Cascade, image: Pixels, rounds: int = ROUNDS) -> Placed:
    return settle(cascade, image, begin(cascade, image, rounds), UNKNOWN, rounds)


def test_groups_hold_every_joint_once() -> None:
    assert sorted(int(j) for group in GROUPS for j in group.reshape(-1)) == list(range(N_JOINTS))


def test_both_sides_of_the_body_look_alike() -> None:
    joints = np.random.default_rng(1).normal(0, 0.3, (N_JOINTS, 3)) + np.array([0.0, 0.0, 2.0])
    mirror = joints[SWAPPED] * [-1.0, 1.0, 1.0]
    for group in GROUPS:
        plain, turned = pose_vectors(joints, group, False, SWAPPED), pose_vectors(mirror, group, False, SWAPPED)
        if len(group) == 2:
            assert plain[0] == pytest.approx(turned[1], abs=1e-6)
        assert pose_vectors(joints, group, True, SWAPPED)[0] == pytest.approx(
            pose_vectors(mirror, group[::-1] if len(group) == 2 else group, False, SWAPPED)[0], abs=1e-6
        )


def test_every_joint_is_placed_near_the_true_one_and_closer_looks_help(
    cascade: Cascade, person: tuple[Pixels, np.ndarray]
) -> None:
    image, truth = person
    errors = [np.linalg.norm(placed(cascade, image, n).joints_m - truth, axis=1) for n in (0, ROUNDS)]
    assert np.isfinite(errors[0]).all()
    assert np.median(errors[1]) < 0.05
    assert errors[1].mean() < errors[0].mean() + 0.005


def test_two_threads_find_what_one_finds(cascade: Cascade, person: tuple[Pixels, np.ndarray]) -> None:
    image, _ = person
    with ThreadPoolExecutor(1) as beside:
        both = settle(cascade, image, begin(cascade, image, ROUNDS, beside), UNKNOWN, ROUNDS, beside)
    alone = placed(cascade, image)
    assert (both.joints_m == alone.joints_m).all() and (both.cues == alone.cues).all()


def test_without_looks_two_threads_give_the_coarse_joints(cascade: Cascade, person: tuple[Pixels, np.ndarray]) -> None:
    image, _ = person
    with ThreadPoolExecutor(1) as beside:
        found = settle(cascade, image, begin(cascade, image, 0, beside), UNKNOWN, 0, beside)
    assert (found.joints_m == placed(cascade, image, 0).joints_m).all()


def test_what_fails_beside_is_raised_here(cascade: Cascade, person: tuple[Pixels, np.ndarray]) -> None:
    image, _ = person
    broken = replace(cascade, coarse=replace(cascade.coarse, head=cascade.coarse.head[:3]))
    with ThreadPoolExecutor(1) as beside, pytest.raises(ValueError):
        settle(broken, image, begin(broken, image, ROUNDS, beside), UNKNOWN, ROUNDS, beside)


def test_a_mirrored_image_gives_the_mirrored_body(cascade: Cascade, person: tuple[Pixels, np.ndarray]) -> None:
    image, truth = person
    turned = image.flat_mm.reshape(image.height, image.width)[:, ::-1]
    k = image.intrinsics * [1, 1, 0, 1] + [0, 0, image.width - 1 - image.intrinsics[2], 0]
    mirrored = replace(image, flat_mm=np.ascontiguousarray(turned).reshape(-1), intrinsics=k)
    start = truth + np.array([0.01, -0.02, 0.01])
    plain, _ = place(cascade.rounds[0], image, start, (ARMS, LEGS, TRUNK))
    other, _ = place(cascade.rounds[0], mirrored, start[SWAPPED] * [-1.0, 1.0, 1.0], (ARMS, LEGS, TRUNK))
    limbs = GROUPS[0].reshape(-1)
    assert np.linalg.norm((plain - other[SWAPPED] * [-1.0, 1.0, 1.0])[limbs], axis=1).max() < 0.01


def test_each_arm_alone_is_placed_as_both_at_once(cascade: Cascade, person: tuple[Pixels, np.ndarray]) -> None:
    image, truth = person
    both_m, both_spread_m = place(cascade.rounds[0], image, truth, (ARMS,))
    for part in (RIGHT_ARM, LEFT_ARM):
        one_m, one_spread_m = place(cascade.rounds[0], image, truth, (part,))
        np.testing.assert_allclose(one_m[part.joints], both_m[part.joints], atol=1e-6)
        np.testing.assert_allclose(one_spread_m[part.joints], both_spread_m[part.joints], rtol=1e-5)
        assert np.isnan(one_spread_m).sum() == N_JOINTS - part.joints.size


def test_the_second_look_moves_arms_alone(cascade: Cascade, person: tuple[Pixels, np.ndarray]) -> None:
    image, _ = person
    once, twice = (placed(cascade, image, rounds) for rounds in (1, 2))
    for part in (LEGS, TRUNK):
        np.testing.assert_array_equal(twice.joints_m[part.joints], once.joints_m[part.joints])
        np.testing.assert_array_equal(twice.spread_m[part.joints], once.spread_m[part.joints])
    assert (twice.joints_m[ARMS.joints] != once.joints_m[ARMS.joints]).all()


def test_a_second_look_at_everything_is_one_too(cascade: Cascade, person: tuple[Pixels, np.ndarray]) -> None:
    image, _ = person
    whole = replace(cascade, rounds=(cascade.rounds[0],) * 2)
    joints_m = placed(whole, image, 1).joints_m
    again_m, spread_m = place(whole.rounds[1], image, joints_m, (ARMS, LEGS, TRUNK))
    found = placed(whole, image, 2)
    np.testing.assert_array_equal(found.joints_m, again_m)
    np.testing.assert_array_equal(found.spread_m, spread_m)


def test_nothing_in_the_image_is_no_error(cascade: Cascade) -> None:
    camera = Camera(open_virtual("builtin,fps=15").performance.take(0).frame.camera.depth)
    one = np.zeros((camera.depth.height, camera.depth.width), bool)
    one[100, 100] = True
    depth = np.where(one, 2000, 0).astype(np.uint16)
    found = placed(cascade, operator_pixels(depth, one, (100, 100, 101, 101), camera))
    assert np.isfinite(found.joints_m).all()


def test_networks_come_back_from_a_file_as_they_were(tmp_path: Path, person: tuple[Pixels, np.ndarray]) -> None:
    model, (image, _) = load_model(), person
    save_model(model, tmp_path / "model.npz")
    again = load_model(tmp_path / "model.npz")
    assert model.cascade is not None and again.cascade is not None
    assert np.array_equal(placed(model.cascade, image).joints_m, placed(again.cascade, image).joints_m)


@pytest.mark.parametrize(("number", "kept"), [(0, 1), (1, 2), (1, 0)])
def test_looks_at_some_of_the_groups_are_refused(tmp_path: Path, cascade: Cascade, number: int, kept: int) -> None:
    rounds = [cascade.rounds[0], cascade.rounds[0]]
    rounds[number] = rounds[number][:kept]
    save_model(replace(load_model(), cascade=replace(cascade, rounds=tuple(rounds))), tmp_path / "some.npz")
    with pytest.raises(ModelError, match=f"look {number}"):
        load_model(tmp_path / "some.npz")


def test_networks_that_do_not_fit_together_are_refused(tmp_path: Path, cascade: Cascade) -> None:
    broken = replace(cascade.coarse, head=cascade.coarse.head[:-1])
    save_model(replace(load_model(), cascade=replace(cascade, coarse=broken)), tmp_path / "broken.npz")
    with pytest.raises(ModelError, match="coarse_head"):
        load_model(tmp_path / "broken.npz")
