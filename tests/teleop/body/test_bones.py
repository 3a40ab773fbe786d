"""Bone lengths are learned from sure frames, and joints agree with them, the unsure end giving way."""

from __future__ import annotations

import numpy as np
import pytest

from teleop.body.bones import KINDS, PAIRS, Bones, learn, straighten, unknown_bones
from teleop.config.body import BonesConfig
from teleop.joints import JOINT_INDEX, N_JOINTS

CONFIG = BonesConfig()
TRUE_M = np.array([0.29, 0.26, 0.42, 0.41])


def body(rng: np.random.Generator) -> np.ndarray:
    """Random limbs of the true lengths."""
    joints = rng.normal(0, 0.3, (N_JOINTS, 3)) + np.array([0.0, 0.0, 2.3])
    for kind in range(len(KINDS)):
        for a, b in PAIRS[kind]:
            d = rng.normal(0, 1, 3)
            joints[b] = joints[a] + TRUE_M[kind] * d / np.linalg.norm(d)
    return joints


def lengths(joints: np.ndarray) -> np.ndarray:
    return np.linalg.norm(joints[PAIRS[:, :, 1]] - joints[PAIRS[:, :, 0]], axis=2)


def learned(frames: int, spread_m: float = 0.01, noise_m: float = 0.01) -> Bones:
    rng, bones = np.random.default_rng(3), unknown_bones()
    for _ in range(frames):
        joints = body(rng) + rng.normal(0, noise_m, (N_JOINTS, 3))
        bones = learn(bones, joints, np.full(N_JOINTS, spread_m), CONFIG)
    return bones


def test_lengths_are_learned_and_unsure_frames_teach_nothing() -> None:
    assert learned(200).length_m == pytest.approx(TRUE_M, abs=0.004)
    assert (learned(200).weight > CONFIG.least_frames).all()
    assert (learned(200, spread_m=0.2).weight == 0).all()
    unknown = np.full((N_JOINTS, 3), np.nan)
    before = learned(5)
    after = learn(before, unknown, np.full(N_JOINTS, 0.01), CONFIG)
    assert (after.length_m == before.length_m).all() and (after.weight == before.weight).all()


def test_the_past_is_forgotten_after_a_while() -> None:
    assert learned(2000).weight == pytest.approx(CONFIG.memory_frames, rel=0.01)


def test_joints_come_nearer_to_the_true_ones() -> None:
    rng, bones = np.random.default_rng(4), learned(300)
    before, after = [], []
    for _ in range(50):
        true = body(rng)
        seen = true + rng.normal(0, 0.02, (N_JOINTS, 3))
        found = straighten(seen, np.full(N_JOINTS, 0.02), bones, CONFIG)
        before.append(np.abs(lengths(seen) - TRUE_M[:, None]).mean())
        after.append(np.abs(lengths(found) - TRUE_M[:, None]).mean())
        assert np.linalg.norm(found - true) < np.linalg.norm(seen - true) * 1.02
    assert np.mean(after) < 0.5 * np.mean(before)


def test_the_unsure_end_gives_way_and_the_unknown_stays_unknown() -> None:
    bones, true = learned(300), body(np.random.default_rng(5))
    shoulder, elbow, wrist = (JOINT_INDEX[f"{n}_right"] for n in ("shoulder", "elbow", "wrist"))
    seen = true.copy()
    seen[elbow] += 0.05 * (true[elbow] - true[shoulder]) / TRUE_M[0]
    seen[wrist] = np.nan
    spread = np.full(N_JOINTS, 0.005)
    spread[elbow] = 0.05
    found = straighten(seen, spread, bones, CONFIG)
    assert np.linalg.norm(found[shoulder] - seen[shoulder]) < 0.1 * np.linalg.norm(found[elbow] - seen[elbow])
    assert np.isnan(found[wrist]).all()


def test_nothing_moves_before_anything_is_known() -> None:
    seen = body(np.random.default_rng(6))
    for bones in (unknown_bones(), learned(3)):
        assert (straighten(seen, np.full(N_JOINTS, 0.02), bones, CONFIG) == seen).all()
