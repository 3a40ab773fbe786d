"""What averaging takes away: votes pull a bent elbow inwards and a shoulder to the chest; neighbours tell by how much.

The correction of a joint is linear in the vectors to its nearest joints along the skeleton and in their lengths, so
it sees how the limb is bent; fitted by ridge regression on validation frames.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.joints import BONES, N_JOINTS

N_NEIGHBOURS: Final = 4
N_CUES: Final = 4 * N_NEIGHBOURS + 1

Floats = npt.NDArray[np.float64]


def _neighbours() -> npt.NDArray[np.int64]:
    """The joints (J, N_NEIGHBOURS) that lie fewest bones away, in order."""
    steps = np.full((N_JOINTS, N_JOINTS), 99)
    np.fill_diagonal(steps, 0)
    for a, b in BONES:
        steps[a, b] = steps[b, a] = 1
    for via in range(N_JOINTS):
        steps = np.minimum(steps, steps[:, [via]] + steps[[via], :])
    return np.argsort(steps, axis=1, kind="stable")[:, 1 : N_NEIGHBOURS + 1]


NEIGHBOURS: Final = _neighbours()


def neighbour_vectors(joints_m: Floats) -> Floats:
    """Vectors (..., J, N_NEIGHBOURS, 3) from each joint to its neighbours, NaN where one is unknown."""
    return np.asarray(joints_m[..., NEIGHBOURS, :] - joints_m[..., :, None, :])


def cues(joints_m: Floats, mean_m: Floats) -> Floats:
    """What the correction is linear in (..., J, N_CUES). mean_m: (J, N_NEIGHBOURS, 3) stands in for the unknown."""
    vectors = neighbour_vectors(joints_m)
    vectors = np.where(np.isnan(vectors), mean_m, vectors)
    flat = vectors.reshape(*vectors.shape[:-2], 3 * N_NEIGHBOURS)
    lengths = np.linalg.norm(vectors, axis=-1)
    return np.concatenate([flat, lengths, np.ones((*lengths.shape[:-1], 1))], axis=-1)


def corrected(joints_m: Floats, weights: Floats, mean_m: Floats, limit_m: float) -> Floats:
    """Joints (20, 3) after the correction, none moved by more than ``limit_m``; unknown stays unknown.

    weights: (J, N_CUES, 3) and mean_m: (J, N_NEIGHBOURS, 3) come from the model.
    """
    move = np.einsum("jc,jcx->jx", cues(joints_m, mean_m), weights)
    length = np.linalg.norm(move, axis=1, keepdims=True)
    return np.asarray(joints_m + move * np.minimum(1.0, limit_m / np.maximum(length, 1e-9)))
