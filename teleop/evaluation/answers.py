"""Running a tracker over frames with a truth."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields, replace
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from teleop.body.parts import N_PARTS
from teleop.config.body import BodyConfig
from teleop.config.intent import LevelConfig
from teleop.evaluation.cases import Case
from teleop.frames import Camera, DepthFrame
from teleop.joints import N_JOINTS
from teleop.level import rotation_level_camera
from teleop.skeleton import BodyParts, Track

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]


class Tracker(Protocol):
    """What is measured: anything with the interface of teleop.body.tracker.BodyTracker."""

    def initial_state(self) -> Any: ...

    def step(self, frame: DepthFrame, state: Any) -> tuple[Track, Any]: ...

    def warm_up(self, camera: Camera) -> None: ...


@dataclass(frozen=True, slots=True, eq=False)
class Answers:
    """F frames. joints_m (F, 20, 3), NaN unknown; confidence (F, 20); truth_m (F, 20, 3), which of it is counted.

    level_found, level_true: (F, 3, 3) rotations to levelled axes, the tracker's own where it saw the floor.
    group, level: as in Case. found: (F,) a person was found. confusion: (P, P) pixels, true part by answered part.
    """

    joints_m: Floats
    confidence: Floats
    truth_m: Floats
    counted: Bools
    level_found: Floats
    level_true: Floats
    group: npt.NDArray[np.int64]
    level: Floats
    found: Bools
    confusion: npt.NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.group)

    def where(self, chosen: Bools) -> Answers:
        """Some of the frames; the confusion stays that of all."""
        rows = {f.name: getattr(self, f.name)[chosen] for f in fields(self) if f.name != "confusion"}
        return Answers(**rows, confusion=self.confusion)

    def of_group(self, group: int) -> Answers:
        """The frames of one group."""
        return self.where(self.group == group)


def joined(many: list[Answers]) -> Answers:
    """Answers of several runs as one."""
    rows = {
        f.name: np.concatenate([getattr(a, f.name) for a in many]) for f in fields(Answers) if f.name != "confusion"
    }
    return Answers(**rows, confusion=np.sum([a.confusion for a in many], axis=0))


def run_tracker(
    tracker: Tracker, cases: Iterable[Case], *, single: bool, advance: Callable[[], None] = lambda: None
) -> Answers:
    """Track frames in order. single: each alone, from the initial state; else a change of group begins anew."""
    rows, confusion = [], np.zeros((N_PARTS, N_PARTS), np.int64)
    state, group, warm = tracker.initial_state(), None, None
    for case in cases:
        if case.frame.camera != warm:
            warm = case.frame.camera
            tracker.warm_up(warm)
        if single or case.group != group:
            state, group = tracker.initial_state(), case.group
        track, state = tracker.step(case.frame, state)
        skeleton = track.skeleton
        joints = np.full((N_JOINTS, 3), np.nan) if skeleton is None else skeleton.joints_m
        confidence = np.zeros(N_JOINTS) if skeleton is None else skeleton.confidence
        true_level = np.eye(3) if case.R_level_camera is None else case.R_level_camera
        level = true_level if track.floor is None else rotation_level_camera(track.floor, LevelConfig())
        if case.R_level_camera is None:
            level = true_level
        rows.append(
            (
                joints,
                confidence,
                case.joints_m,
                case.counted,
                level,
                true_level,
                case.group,
                case.level,
                skeleton is not None,
            )
        )
        if track.parts is not None and case.part is not None:
            add_confusion(confusion, track.parts, case.part)
        advance()
    columns = [np.array(column) for column in zip(*rows, strict=True)]
    joints_m, sure, truth_m, counted, found_R, true_R, groups, levels, found = columns
    return Answers(joints_m, sure, truth_m, counted, found_R, true_R, groups, levels, found, confusion)


def add_confusion(confusion: npt.NDArray[np.int64], parts: BodyParts, true_part: npt.NDArray[np.uint8]) -> None:
    """Count the person's pixels by true and by likeliest part; a model with other parts than ours is not counted."""
    if parts.probability.shape[1] != N_PARTS:
        return
    true = true_part[parts.v, parts.u]
    on = true < N_PARTS
    np.add.at(confusion, (true[on], parts.probability[on].argmax(axis=1)), 1)


def single_frame(config: BodyConfig) -> BodyConfig:
    """The configuration without its temporal filter."""
    return config.model_copy(update={"filter": config.filter.model_copy(update={"enabled": False})})


def apart(cases: Iterable[Case], every_s: float = 10.0) -> Iterable[Case]:
    """The same frames, far apart in time."""
    for n, case in enumerate(cases):
        yield replace(case, frame=replace(case.frame, t_ns=round(n * every_s * 1e9)))
