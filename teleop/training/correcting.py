"""Fitting the joint correction (teleop.body.correction) on validation frames."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.body.assemble import assemble
from teleop.body.correction import N_CUES, cues, neighbour_vectors
from teleop.body.model import BodyModel
from teleop.body.votes import Proposals
from teleop.config.body import BodyConfig
from teleop.joints import MIRROR_JOINT, N_JOINTS

INLIER_M: Final = 0.12
"""A joint farther from the truth is a wrong mode, nothing a correction could learn from."""
RIDGE: Final = 1.0

Floats = npt.NDArray[np.float64]


def fit_correction(model: BodyModel, proposals: list[Proposals], joints_m: Floats, config: BodyConfig) -> BodyModel:
    """The model with its correction fitted. joints_m: (F, 20, 3) truth. Every frame also counts as its mirror image."""
    found = np.stack([assemble(p, model.bones_m, None, config.skeleton)[0] for p in proposals])
    truth = joints_m[: len(found)]
    mirror = np.array([-1.0, 1.0, 1.0])
    found = np.concatenate([found, found[:, list(MIRROR_JOINT)] * mirror])
    truth = np.concatenate([truth, truth[:, list(MIRROR_JOINT)] * mirror])
    mean_m = np.nan_to_num(np.nanmedian(neighbour_vectors(found), axis=0))
    rows = cues(found, mean_m)
    weights = np.zeros((N_JOINTS, N_CUES, 3))
    for j in range(N_JOINTS):
        error = truth[:, j] - found[:, j]
        good = np.linalg.norm(error, axis=1) < INLIER_M  # False where unknown
        if good.sum() >= 10 * N_CUES:
            x = rows[good, j]
            weights[j] = np.linalg.solve(x.T @ x + RIDGE * np.eye(N_CUES), x.T @ error[good])
    return replace(model, correction=weights, correction_mean_m=mean_m)
