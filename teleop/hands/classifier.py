"""Open or closed from a hand's features: logistic regression with products of features, weights in ``weights.py``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.hands import weights
from teleop.hands.features import FEATURES

COLOR_FEATURES: Final = ("skin", "edges")
CLIP: Final = 4.0
"""Standard deviations a feature counts for at most: a mask gone wrong must not outvote everything."""


@dataclass(frozen=True, slots=True, eq=False)
class Classifier:
    """columns: the features used. mean, deviation: (n,) of each. weight: (1 + n + n (n + 1) / 2,)."""

    columns: npt.NDArray[np.int64]
    mean: npt.NDArray[np.float64]
    deviation: npt.NDArray[np.float64]
    weight: npt.NDArray[np.float64]

    def logit(self, features: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Log odds of an open hand, of features (..., len(FEATURES))."""
        return expand(features[..., self.columns], self.mean, self.deviation) @ self.weight


def columns(color: bool) -> npt.NDArray[np.int64]:
    """The features used with and without colour."""
    return np.array([i for i, name in enumerate(FEATURES) if color or name not in COLOR_FEATURES], dtype=np.int64)


def expand(
    x: npt.NDArray[np.float64], mean: npt.NDArray[np.float64], deviation: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """One, the standardised features, and all products of two of them."""
    z = np.clip((x - mean) / deviation, -CLIP, CLIP)
    i, j = np.triu_indices(z.shape[-1])
    return np.concatenate([np.ones((*z.shape[:-1], 1)), z, z[..., i] * z[..., j]], axis=-1)


def _shipped(color: bool, stored: dict[str, tuple[float, ...]]) -> Classifier:
    return Classifier(columns(color), *(np.array(stored[name]) for name in ("mean", "deviation", "weight")))


WITH_COLOR: Final = _shipped(True, weights.WITH_COLOR)
DEPTH_ONLY: Final = _shipped(False, weights.DEPTH_ONLY)
