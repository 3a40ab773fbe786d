"""How sure is a joint? A logistic regression on what the cascade tells about it, fitted on validation frames."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.body.assemble import assemble
from teleop.body.cascade import begin, settle
from teleop.body.features import body_pixels, body_points
from teleop.body.forest import forest_leaves, stride_for
from teleop.body.model import BodyModel
from teleop.body.votes import propose, vote_weights
from teleop.config.body import BodyConfig
from teleop.errors import ModelError
from teleop.training.bodies import Bodies
from teleop.training.fitting import logistic_weights
from teleop.training.images import Images, image_of

NEAR_M: Final = 0.1
"""Confidence is the probability that a joint is nearer than this to the true one."""

Floats = npt.NDArray[np.float64]


def placed_frames(
    model: BodyModel, bodies: Bodies, images: Images, frames: range, config: BodyConfig
) -> tuple[Floats, Floats]:
    """Joints (F, 20, 3) and cues (F, 20, N_CUES) of some frames. images: the bodies, padded. Raises ModelError without
    networks."""
    if model.cascade is None:
        raise ModelError("the model has no networks to place joints with; train it with 'teleop train'")
    joints, cues = [], []
    weight_of, rounds = vote_weights(config.proposals), config.cascade.rounds
    for f in frames:
        image = image_of(images, f)
        area = int((image.depth_mm < image.depth_mm.max()).sum())
        stride = stride_for(area, config.forest.max_pixels)
        where = body_pixels(image.depth_mm, stride)
        leaves = forest_leaves(model, image, where)
        points = body_points(image, where)
        proposals = propose(model, points, leaves, stride, image.fx, weight_of, config.proposals)
        forest_m, _ = assemble(proposals, model.bones_m, None, config.skeleton)
        pixels = bodies.pixels(f)
        placed = settle(model.cascade, pixels, begin(model.cascade, pixels, rounds), forest_m, rounds)
        joints.append(placed.joints_m)
        cues.append(placed.cues)
    return np.array(joints), np.array(cues)


def placed_errors_m(model: BodyModel, bodies: Bodies, images: Images, frames: range, config: BodyConfig) -> Floats:
    """Distance (F, 20) of the final joints from the truth."""
    joints, _ = placed_frames(model, bodies, images, frames, config)
    return np.asarray(np.linalg.norm(joints - bodies.joints_m[frames.start : frames.stop], axis=2))


def fit_trust(model: BodyModel, bodies: Bodies, images: Images, frames: range, config: BodyConfig) -> BodyModel:
    """The model with its trust fitted on some frames.

    Joints that are not visible count as well: their confidence must fall.
    """
    joints, cues = placed_frames(model, bodies, images, frames, config)
    error = np.linalg.norm(joints - bodies.joints_m[frames.start : frames.stop], axis=2)
    rows = np.concatenate([cues, np.ones((*cues.shape[:2], 1))], axis=2).reshape(-1, cues.shape[2] + 1)
    weights = logistic_weights(rows, (error < NEAR_M).reshape(-1), 0.3, balanced=False)
    return replace(model, cascade=None if model.cascade is None else replace(model.cascade, trust=weights))
