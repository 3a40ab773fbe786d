"""Running the tracker over frames with a truth: rendered people it never saw, and the real recordings."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from teleop.body.features import pad_image, working_step
from teleop.body.forest import infer, stride_for
from teleop.body.segmentation import candidate, look, rank
from teleop.body.tracker import BodyTracker
from teleop.body.votes import propose, vote_weights
from teleop.config.body import BodyConfig
from teleop.frames import DepthFrame
from teleop.joints import N_JOINTS
from teleop.training.real import load_real

STAGES: tuple[str, ...] = ("segmentation", "forest", "mean shift", "whole step")


@dataclass(frozen=True, slots=True, eq=False)
class Answers:
    """F frames: joints (F, 20, 3), NaN unknown, confidence, truth, which truths count (F, 20), group (F,) such as the
    subject, seconds (F,) a step took, pixels (F,) of the operator."""

    joints_m: npt.NDArray[np.float64]
    confidence: npt.NDArray[np.float64]
    truth_m: npt.NDArray[np.float64]
    counted: npt.NDArray[np.bool_]
    group: npt.NDArray[np.int64]
    seconds: npt.NDArray[np.float64]
    area_px: npt.NDArray[np.int64]

    def of_group(self, group: int) -> Answers:
        """The frames of one group."""
        at = self.group == group
        return Answers(
            self.joints_m[at],
            self.confidence[at],
            self.truth_m[at],
            self.counted[at],
            self.group[at],
            self.seconds[at],
            self.area_px[at],
        )


Truth = tuple[DepthFrame, npt.NDArray[np.float64], npt.NDArray[np.bool_], int]


def run_tracker(tracker: BodyTracker, frames: Iterable[Truth], advance: Callable[[], None]) -> Answers:
    """Track frames in order. Each comes with its truth (20, 3), which of it counts (20,) and its group."""
    state, warm = tracker.initial_state(), False
    rows = []
    for frame, truth, counted, group in frames:
        if not warm:
            tracker.warm_up(frame.camera)
            warm = True
        start = time.perf_counter()
        track, state = tracker.step(frame, state)
        seconds = time.perf_counter() - start
        skeleton = track.skeleton
        joints = np.full((N_JOINTS, 3), np.nan) if skeleton is None else skeleton.joints_m
        confidence = np.zeros(N_JOINTS) if skeleton is None else skeleton.confidence
        area = 0 if track.mask is None else int(track.mask.sum())
        rows.append((joints, confidence, truth, counted, group, seconds, area))
        advance()
    return Answers(*(np.array(column) for column in zip(*rows, strict=True)))


def rendered(count: int, width: int, height: int, room: bool) -> Iterable[Truth]:
    """Rendered people of the test split, every second one mirrored; far apart in time, so that each is single."""
    from teleop.people.sampling import SampleSpec, sample_frame

    for seed in range(count):
        spec = SampleSpec(split="test", width=width, height=height, room=room, mirrored=bool(seed % 2))
        shot = sample_frame(seed, spec)
        yield replace(shot.frame, t_ns=seed * 10**10), shot.joints_m, shot.visible, int(room)


def real(every: int) -> Iterable[Truth]:
    """The real recordings; the group is the subject. Only joints that agree with the depth image count."""
    for r in load_real(every):
        yield r.frame, r.joints_m, r.trusted, r.subject


def single_frame(config: BodyConfig) -> BodyConfig:
    """The configuration without its temporal filter."""
    return config.model_copy(update={"filter": config.filter.model_copy(update={"enabled": False})})


def time_stages(tracker: BodyTracker, frames: Iterable[DepthFrame], repeats: int) -> npt.NDArray[np.float64]:
    """Seconds (F * repeats, stages) of each of STAGES on one thread; frames without an operator are left out."""
    config, model, out = tracker.config, tracker.model, []
    weight_of, max_offset_m = vote_weights(config.proposals), model.max_offset_m
    for frame in frames:
        tracker.warm_up(frame.camera)
        step = working_step(frame.camera, config.forest.working_focal_px)
        state = tracker.initial_state()
        for n in range(repeats):
            t = [time.perf_counter()]
            scene = look(frame, state.floor, config.floor, config.segmentation)
            labels = rank(scene, state.cells, config.segmentation)
            found = candidate(frame, scene, labels[0], config.segmentation) if labels else None
            t.append(time.perf_counter())
            if found is None:
                break
            image = pad_image(frame.depth_mm, found.mask, found.box, frame.camera, max_offset_m, step)
            stride = stride_for(found.area_px // step**2, config.forest.max_pixels)
            parts, leaves = infer(model, image, stride, step, frame.camera.mirrored)
            t.append(time.perf_counter())
            propose(model, parts.points_m, leaves, stride, image.fx, weight_of, config.proposals)
            t.append(time.perf_counter())
            _, state = tracker.step(replace(frame, t_ns=n * 33_000_000), state)
            t.append(time.perf_counter())
            out.append(np.diff(t))
    return np.array(out).reshape(-1, len(STAGES))
