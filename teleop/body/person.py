"""Is this surface a person? A logistic regression on how well the body model fits it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import numpy.typing as npt

from teleop.joints import BONES, JOINT_INDEX
from teleop.skeleton import BodyParts

if TYPE_CHECKING:
    from teleop.body.cascade import Placed
    from teleop.body.votes import Proposals

TRUNK: Final = tuple(JOINT_INDEX[n] for n in ("head", "shoulder_center", "shoulder_right", "shoulder_left", "spine"))
"""What must be seen for a surface to be an operator."""
N_FEATURES: Final = 14
_ENDS: Final = np.array(BONES)


def person_features(
    parts: BodyParts,
    proposals: Proposals,
    joints_m: npt.NDArray[np.float64],
    placed: Placed | None,
    cells: float,
    bones_m: npt.NDArray[np.float64],
    focal_px: float,
) -> npt.NDArray[np.float64]:
    """Cues (N_FEATURES,): how person-like the cells are, sharpness of the parts, vote mass of the trunk and of all
    joints, errors of bone lengths, thickness of the surface (a box or a wall is flat), area, height, head above the
    spine; then from the networks their spreads, how far they moved joints and are from the forest's, errors of bone
    lengths.

    joints_m: the forest's. placed: the networks', None without. cells: see Candidate.person.
    """
    trunk = list(TRUNK)
    points = parts.points_m.astype(np.float64)
    area_m2 = float(((points[:, 2] * parts.stride / focal_px) ** 2).sum())
    low, high = np.quantile(points[:, 1], (0.01, 0.99))
    rise_m = joints_m[JOINT_INDEX["head"], 1] - joints_m[JOINT_INDEX["spine"], 1]
    mass = np.log(np.clip(np.nan_to_num(proposals.scores[:, 0]), 1e-3, 10.0))
    return np.array(
        [
            cells,
            float(parts.probability.max(axis=1).mean()),
            float(mass[trunk].mean()),
            float(mass.mean()),
            _bone_error(joints_m, bones_m),
            float(np.sqrt(max(np.linalg.eigvalsh(np.cov(points.T))[0], 0.0))) if len(points) > 3 else 0.0,
            np.log(max(area_m2, 1e-3)),
            high - low,
            float(np.clip(np.nan_to_num(rise_m, nan=0.0), -1.0, 1.0)),
            *_network_features(placed, bones_m),
        ]
    )


def _bone_error(joints_m: npt.NDArray[np.float64], bones_m: npt.NDArray[np.float64]) -> float:
    """Mean relative error of the bone lengths, 1 for an unknown or worse one."""
    lengths = np.linalg.norm(joints_m[_ENDS[:, 0]] - joints_m[_ENDS[:, 1]], axis=1)
    return float(np.minimum(np.nan_to_num(np.abs(lengths / bones_m - 1.0), nan=1.0), 1.0).mean())


def _network_features(placed: Placed | None, bones_m: npt.NDArray[np.float64]) -> list[float]:
    if placed is None:
        return [0.0] * 5
    coarse, fine, moved, apart = placed.cues[:, :4].mean(axis=0)
    return [float(coarse), float(fine), float(moved), float(apart), _bone_error(placed.joints_m, bones_m)]


def design(features: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Features (..., N_FEATURES) with their squares and a one: what the weights multiply."""
    return np.concatenate([features, features**2, np.ones((*features.shape[:-1], 1))], axis=-1)


def person_probability(features: npt.NDArray[np.float64], weights: npt.NDArray[np.float64]) -> float:
    """Probability 0..1 that the surface is a person. weights: (2 N_FEATURES + 1,), fitted in training."""
    return float(1.0 / (1.0 + np.exp(-np.clip(design(features) @ weights, -50.0, 50.0))))
