"""What is fitted on validation frames: bandwidth, reference weight and the like, joint by joint."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from teleop.body.features import body_pixels, body_points
from teleop.body.forest import forest_leaves, stride_for
from teleop.body.model import BodyModel
from teleop.body.parts import NO_PART
from teleop.body.person import design
from teleop.body.segmentation import candidate, look, rank
from teleop.body.tracker import BodyTracker
from teleop.body.votes import Proposals, propose, vote_weights
from teleop.config.body import BodyConfig
from teleop.errors import ModelError
from teleop.frames import DepthFrame
from teleop.joints import N_JOINTS
from teleop.training.dataset import Frames
from teleop.training.images import Images, image_of

BANDWIDTHS_M: Final = (0.025, 0.035, 0.05, 0.07, 0.1)
REFERENCE_QUANTILE: Final = 0.3
"""A joint seen as well as this share of the visible ones, or better, has confidence 1."""


@dataclass(frozen=True, slots=True, eq=False)
class Walked:
    """A frame after the forest, so that votes can be tried again and again."""

    points_m: npt.NDArray[np.float32]
    leaves: npt.NDArray[np.int32]
    stride: int
    focal_px: float


def walk_frames(model: BodyModel, images: Images, count: int, config: BodyConfig) -> list[Walked]:
    """Run the forest over the first ``count`` frames."""
    out = []
    for f in range(min(count, len(images))):
        image = image_of(images, f)
        area = int((image.depth_mm < image.depth_mm.max()).sum())
        stride = stride_for(area, config.forest.max_pixels)
        where = body_pixels(image.depth_mm, stride)
        out.append(Walked(body_points(image, where), forest_leaves(model, image, where), stride, image.fx))
    return out


def propose_all(model: BodyModel, walked: list[Walked], config: BodyConfig) -> list[Proposals]:
    """Proposals of every walked frame."""
    weight_of = vote_weights(config.proposals)
    return [propose(model, w.points_m, w.leaves, w.stride, w.focal_px, weight_of, config.proposals) for w in walked]


def best_errors_m(proposals: list[Proposals], joints_m: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Distance (F, 20) of the best proposal from the truth, 1 m where there is none."""
    first = np.stack([p.modes_m[:, 0] for p in proposals])
    return np.nan_to_num(np.linalg.norm(first - joints_m[: len(first)], axis=2), nan=1.0)


def fit_model(model: BodyModel, images: Images, frames: int, config: BodyConfig) -> BodyModel:
    """The model with bandwidths and references fitted on validation frames.

    Bandwidth: least mean error, each frame's error cut at 0.2 m so that a swapped hand does not decide. Reference: a
    quantile of the summed weight at the best mode over visible joints.
    """
    walked = walk_frames(model, images, frames, config)
    truth, visible = images.joints_m[: len(walked)], images.visible[: len(walked)]
    model = replace(model, reference=np.ones(N_JOINTS))
    tried, scores = [], []
    for bandwidth in BANDWIDTHS_M:
        trial = replace(model, bandwidth_m=np.full(N_JOINTS, bandwidth))
        proposals = propose_all(trial, walked, config)
        error = np.minimum(best_errors_m(proposals, truth), 0.2)
        tried.append(np.nanmean(np.where(visible, error, np.nan), axis=0))
        scores.append(np.stack([p.scores[:, 0] for p in proposals]))
    best = np.argmin(np.stack(tried), axis=0)
    reference = np.ones(N_JOINTS)
    for j in range(N_JOINTS):
        seen = scores[best[j]][visible[:, j], j]
        reference[j] = max(float(np.quantile(seen, REFERENCE_QUANTILE)), 1e-9)
    return replace(model, bandwidth_m=np.array(BANDWIDTHS_M)[best], reference=reference)


def logistic_weights(
    rows: npt.NDArray[np.float64], labels: npt.NDArray[np.bool_], ridge: float, balanced: bool = True
) -> npt.NDArray[np.float64]:
    """Weights (D,) of a ridge-regularised logistic regression on rows (N, D); balanced: both classes weigh the same.

    Newton's method; the ridge acts on standardised columns, the last column is the constant one.
    """
    mean, scale = rows[:, :-1].mean(axis=0), rows[:, :-1].std(axis=0) + 1e-9
    x = np.concatenate([(rows[:, :-1] - mean) / scale, np.ones((len(rows), 1))], axis=1)
    y = labels.astype(np.float64)
    sample = np.ones(len(rows))
    if balanced:
        sample = np.where(labels, 0.5 / max(labels.sum(), 1), 0.5 / max((~labels).sum(), 1)) * len(rows)
    penalty = np.full(x.shape[1], ridge)
    penalty[-1] = 1e-6
    w = np.zeros(x.shape[1])
    for _ in range(50):
        p = 1.0 / (1.0 + np.exp(-np.clip(x @ w, -30, 30)))
        gradient = x.T @ (sample * (p - y)) + penalty * w
        hessian = (x * (sample * p * (1 - p))[:, None]).T @ x + np.diag(penalty + 1e-9)
        step = np.linalg.solve(hessian, gradient)
        w = w - step
        if np.abs(step).max() < 1e-8:
            break
    plain = w[:-1] / scale
    return np.append(plain, w[-1] - plain @ mean)


def fit_person(model: BodyModel, chunks: Iterable[Frames], config: BodyConfig) -> BodyModel:
    """The model with person weights fitted on rendered frames, with people and without.

    A surface is a person when more than half of it is one, nobody when less than a tenth is.
    """
    every = config.person.model_copy(update={"min_cells": 0.0})
    tracker = BodyTracker(model, config.model_copy(update={"person": every}))
    finder = model.finder if config.cascade.finder else None
    rows, labels = [], []
    for frames in chunks:
        for f in range(len(frames)):
            frame = DepthFrame(0, frames.depth_mm[f], frames.camera(f))
            people = (frames.part[f] != NO_PART) | frames.others[f]
            # without the finder's cut things are surfaces, too: what is no person is to be seen here
            for net in (finder, None):
                scene = look(frame, None, net, config.floor, config.segmentation)
                for label in rank(scene, None, config.segmentation):
                    found = candidate(frame, scene, label, config.segmentation)
                    if found is None:
                        continue
                    share = float(people[found.mask].mean())
                    if share > 0.5 or share < 0.1:
                        rows.append(design(tracker.cues(frame, found, tracker.estimate(frame, found, None))))
                        labels.append(share > 0.5)
    is_person = np.array(labels)
    if len(rows) == 0 or is_person.all() or not is_person.any():
        raise ModelError("the frames show no people or nothing else; render more to fit what tells them apart")
    return replace(model, person_weights=logistic_weights(np.array(rows), is_person, 0.3))
