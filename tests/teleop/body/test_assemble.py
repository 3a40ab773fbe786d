"""The choice among proposals is the cheapest one, and it hides what is not sure."""

import itertools

import numpy as np

from teleop.body.assemble import assemble, best_modes
from teleop.body.votes import Proposals
from teleop.config.body import SkeletonConfig
from teleop.joints import BONES, N_JOINTS


def test_dynamic_programme_equals_brute_force() -> None:
    rng = np.random.default_rng(4)
    parent, child = np.array([0, 1, 1]), np.array([1, 2, 3])
    for _ in range(50):
        modes, unary = rng.uniform(0, 1, (4, 3, 3)), rng.uniform(0, 2, (4, 3))
        bones = rng.uniform(0.2, 0.8, 3)

        def cost(pick: tuple[int, ...], modes=modes, unary=unary, bones=bones) -> float:
            total = sum(unary[j, k] for j, k in enumerate(pick))
            for b in range(3):
                d = np.linalg.norm(modes[parent[b], pick[parent[b]]] - modes[child[b], pick[child[b]]])
                total += min(((d / bones[b] - 1) / 0.3) ** 2, 9.0)
            return total

        best = min(itertools.product(range(3), repeat=4), key=cost)
        assert tuple(best_modes(modes, unary, parent, child, bones, 0.3)) == best


def body() -> tuple[np.ndarray, np.ndarray]:
    """Some joints in space and the bone lengths between them."""
    joints = np.random.default_rng(9).uniform(-0.5, 0.5, (N_JOINTS, 3)) + np.array([0, 0, 2])
    ends = np.array(BONES)
    return joints, np.linalg.norm(joints[ends[:, 0]] - joints[ends[:, 1]], axis=1)


def test_wrong_mode_of_equal_weight_is_rejected_by_its_bone() -> None:
    joints, bones = body()
    modes = np.full((N_JOINTS, 2, 3), np.nan)
    modes[:, 0] = joints
    scores = np.zeros((N_JOINTS, 2))
    scores[:, 0] = 1.0
    modes[6, 1], scores[6, 1] = joints[6], 1.0
    modes[6, 0] = joints[6] + [0.9, 0.4, 0]
    found, confidence = assemble(Proposals(modes, scores), bones, None, SkeletonConfig())
    np.testing.assert_allclose(found, joints)
    assert (confidence == 1).all()


def test_unsure_joint_is_unknown() -> None:
    joints, bones = body()
    scores = np.ones((N_JOINTS, 1))
    scores[3] = 0.001
    found, confidence = assemble(Proposals(joints[:, None], scores), bones, None, SkeletonConfig())
    assert np.isnan(found[3]).all()
    assert not np.isnan(np.delete(found, 3, axis=0)).any()
    assert confidence[3] < 0.01


def test_end_of_an_impossible_bone_is_unknown() -> None:
    joints, bones = body()
    scores = np.ones((N_JOINTS, 1))
    scores[6] = 0.5
    far = joints.copy()
    far[6] += [2.0, 0.0, 0.0]
    found, confidence = assemble(Proposals(far[:, None], scores), bones, None, SkeletonConfig())
    assert np.isnan(found[6]).all()
    assert confidence[6] < 0.1
    assert not np.isnan(np.delete(found, 6, axis=0)).any()
