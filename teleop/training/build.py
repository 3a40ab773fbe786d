"""From rendered frames to a body model: trees one after another, then what is fitted on validation frames."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from teleop.body.model import BodyModel
from teleop.body.person import N_FEATURES
from teleop.joints import BONES, N_JOINTS
from teleop.training.images import Images, draw_pixels
from teleop.training.leaves import Leaves, fill_leaves
from teleop.training.trainer import Tree, TreeSpec, grow_tree

START_BANDWIDTH_M: Final = 0.06
"""Mean-shift bandwidth before it is fitted; the published mean is 0.065 m."""


@dataclass(frozen=True, slots=True)
class BuildSpec:
    """What to train. pixels: drawn per frame for the structure of a tree; leaf_pixels: for the contents of its leaves.
    slots: votes a leaf keeps. balance: see draw_pixels."""

    trees: int = 3
    pixels: int = 200
    leaf_pixels: int = 400
    slots: int = 8
    balance: float = 0.5
    tree: TreeSpec = field(default_factory=TreeSpec)


Progress = Callable[[str, float], None]
"""Called with what is being done and the share 0..1 of it that is done."""


def bone_lengths(joints_m: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Mean length (B,) of each bone over frames (F, 20, 3)."""
    ends = np.array(BONES)
    return np.asarray(np.linalg.norm(joints_m[:, ends[:, 0]] - joints_m[:, ends[:, 1]], axis=2).mean(axis=0))


def join_trees(
    trees: list[Tree], leaves: list[Leaves], bones_m: npt.NDArray[np.float64], meta: dict[str, Any]
) -> BodyModel:
    """One model of several trees; what fitting.py and the networks learn is still to come."""
    node_base = np.cumsum([0, *(len(t.children) for t in trees)])
    leaf_base = np.cumsum([0, *(len(c.parts) for c in leaves)])
    return BodyModel(
        roots=node_base[:-1].astype(np.int32),
        offsets=np.concatenate([t.offsets for t in trees]),
        thresholds_mm=np.concatenate([t.thresholds_mm for t in trees]),
        children=np.concatenate([t.children + base for t, base in zip(trees, node_base, strict=False)]).astype(
            np.int32
        ),
        leaves=np.concatenate(
            [np.where(t.leaves >= 0, t.leaves + base, -1) for t, base in zip(trees, leaf_base, strict=False)]
        ).astype(np.int32),
        leaf_parts=np.concatenate([c.parts for c in leaves]),
        vote_joint=np.concatenate([c.vote_joint for c in leaves]),
        vote_mm=np.concatenate([c.vote_mm for c in leaves]),
        vote_spread=np.concatenate([c.vote_spread for c in leaves]),
        bandwidth_m=np.full(N_JOINTS, START_BANDWIDTH_M),
        reference=np.ones(N_JOINTS),
        bones_m=bones_m,
        person_weights=np.zeros(2 * N_FEATURES + 1),
        max_depth=max(t.max_depth for t in trees),
        meta=meta,
    )


def build_model(images: Images, spec: BuildSpec, seed: int, progress: Progress) -> BodyModel:
    """Train all trees. Same images, spec and seed: same model."""
    trees: list[Tree] = []
    contents: list[Leaves] = []
    for number in range(spec.trees):
        name = f"tree {number + 1} of {spec.trees}"
        rng = np.random.default_rng([seed, number])
        pixels = draw_pixels(images, spec.pixels, rng, spec.balance)
        tree: Tree | None = None
        for level, grown in grow_tree(images, pixels, spec.tree, int(rng.integers(2**31))):
            tree = grown
            progress(name, level / (spec.tree.depth + 2))
        if tree is None:
            raise AssertionError("a tree that is grown ends with its result")
        trees.append(tree)
        contents.append(fill_leaves(images, draw_pixels(images, spec.leaf_pixels, rng, 0.0), tree, spec.slots))
        progress(name, 1.0)
    return join_trees(trees, contents, bone_lengths(images.joints_m), {"seed": seed, "frames": len(images)})
