"""The source's leg study (its table 1): which of six vectors of the legs keeps the steadiest angle at work."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from robot_sim.studies.figures import new_figure, save
from robot_sim.studies.report import Cell, Report, table
from teleop.body.model import load_model
from teleop.body.tracker import BodyTracker
from teleop.config.body import BodyConfig
from teleop.frames import DepthFrame
from teleop.joints import JOINT_INDEX
from teleop.studies.leg_performance import PEOPLE, perform

F64 = npt.NDArray[np.float64]
JOINT_OF: Final = {"H": "hip", "K": "knee", "A": "ankle", "F": "foot"}
SOURCE_DEG2: Final = {"H-K": 0.53, "H-A": 1.11, "H-F": 1.21, "K-A": 0.93, "K-F": 1.63, "A-F": 1.32}
"""Variance of the angle between the right and the left vector, mean over ten people [deg^2]; source, table 1."""
PAIRS: Final = tuple(SOURCE_DEG2)
BURST: Final = 4


def pair_angles_deg(joints_m: F64) -> F64:
    """Angles in space between right and left vector of every pair of PAIRS (6,) [deg], of joints (20, 3); NaN where
    a joint is not known."""
    out = np.full(len(PAIRS), np.nan)
    for i, pair in enumerate(PAIRS):
        a, b = (JOINT_OF[letter] for letter in pair.split("-"))
        right, left = (joints_m[JOINT_INDEX[f"{b}_{s}"]] - joints_m[JOINT_INDEX[f"{a}_{s}"]] for s in ("right", "left"))
        norm = np.linalg.norm(right) * np.linalg.norm(left)
        if np.isfinite(norm) and norm > 0:
            out[i] = np.degrees(np.arccos(np.clip(right @ left / norm, -1.0, 1.0)))
    return out


def within_task_variance(angles_deg: F64, picking: npt.NDArray[np.bool_]) -> F64:
    """Variance (6,) [deg^2] of angles (N, 6) within each of the two tasks, the mean of both."""
    return np.asarray(np.mean([np.nanvar(angles_deg[picking == task], axis=0) for task in (True, False)], axis=0))


@dataclass(frozen=True, slots=True, eq=False)
class LegStudy:
    """Variances [deg^2], (people, 6): of the true joints, and of the tracked ones, single frames and as the tracker
    smooths them. known: share of frames (6,)."""

    true_deg2: F64
    single_deg2: F64
    tracked_deg2: F64
    known: F64
    page: Path

    @property
    def steadiest(self) -> str:
        """The pair of the smallest mean variance, tracked."""
        return PAIRS[int(np.argmin(self.tracked_deg2.mean(axis=0)))]


def run_leg_study(
    folder: Path,
    seconds: int = 300,
    seed: int = 0,
    progress: Callable[[str, int, int], None] | None = None,
    burst: int = BURST,
) -> LegStudy:
    """Ten people, once a second for so long, through the tracker; writes report, tables, plot. Raises DataError.

    burst: frames at 30 Hz up to every sample, over which the tracker smooths as it does while it runs.
    """
    config = BodyConfig()
    tracker = BodyTracker(load_model(), config)
    true: list[F64] = []
    single: list[F64] = []
    tracked: list[F64] = []
    known: list[F64] = []
    for number in range(len(PEOPLE)):
        angles: list[tuple[F64, F64, F64]] = []
        tasks: list[bool] = []
        for sample in perform(number, seconds, seed, burst=burst):
            alone, smooth = _last(tracker, sample.frames[-1:]), _last(tracker, sample.frames)
            angles.append((pair_angles_deg(sample.joints_m), pair_angles_deg(alone), pair_angles_deg(smooth)))
            tasks.append(sample.picking)
            if progress is not None:
                progress(f"person {number + 1} of {len(PEOPLE)}", number * seconds + len(tasks), len(PEOPLE) * seconds)
        picking, seen = np.array(tasks), np.array(angles)
        for rows, k in ((true, 0), (single, 1), (tracked, 2)):
            rows.append(within_task_variance(seen[:, k], picking))
        known.append(np.isfinite(seen[:, 2]).mean(axis=0))
    study = LegStudy(np.array(true), np.array(single), np.array(tracked), np.mean(known, axis=0), folder / "README.md")
    _write(study, folder, seconds, seed, burst)
    return study


def _last(tracker: BodyTracker, frames: tuple[DepthFrame, ...]) -> F64:
    """The joints (20, 3) of the last of some frames in a row, NaN where they are not known."""
    state, track = tracker.initial_state(), None
    for frame in frames:
        track, state = tracker.step(frame, state)
    return np.full((20, 3), np.nan) if track is None or track.skeleton is None else track.skeleton.joints_m


def _write(study: LegStudy, folder: Path, seconds: int, seed: int, burst: int) -> None:
    report = Report("Which vectors of the legs keep a steady angle", folder)
    ours, truth = study.tracked_deg2.mean(axis=0), study.true_deg2.mean(axis=0)
    alone = study.single_deg2.mean(axis=0)
    report.text(
        f"Ten rendered people (165-190 cm, 45-90 kg) pick and spray for {seconds} s, one sample a second, seed {seed}. "
        "Their legs sway, step and shift weight as recorded people's do (CMU motion capture, standing clips). "
        "Variance of the angle in space between the right and the left vector, within each task, mean over the ten."
    )
    rows = [
        (pair, SOURCE_DEG2[pair], float(ours[i]), float(alone[i]), float(truth[i]), float(100 * study.known[i]))
        for i, pair in enumerate(PAIRS)
    ]
    header = (
        "vector",
        "source [deg^2]",
        "tracked [deg^2]",
        "single frames [deg^2]",
        "true joints [deg^2]",
        "known in frames [%]",
    )
    report.table(table("variances", "Beside the source's table 1", header, rows))
    order = [PAIRS[i] for i in np.argsort(ours)]
    true_best = PAIRS[int(np.argmin(truth))]
    report.text(
        f"Steadiest as tracked: **{study.steadiest}** (order: {', '.join(order)}); of the true joints: {true_best}. "
        + (
            "That is the source's finding."
            if study.steadiest == "H-K"
            else "That is not the source's finding, H-K; the thresholds on T1 and T2 keep to H-K as the source does."
        )
        + f" Tracked: as the tracker runs, over {burst} frames at 30 Hz up to each sample; single frames: each sample "
        "by itself. The source does not say how its people stood; ours move their legs as recorded people do, which "
        "the row of the true joints shows: what lies above it is the tracker's."
    )
    per_person: list[list[Cell]] = [
        [f"{100 * h:.0f} cm, {m:.0f} kg", *(float(v) for v in row)]
        for (h, m), row in zip(PEOPLE, study.tracked_deg2, strict=True)
    ]
    report.csv_only(table("people", "Tracked variance of each person [deg^2]", ("person", *PAIRS), per_person))
    figure = new_figure(8.5, 4.2)
    ax = figure.add_subplot()
    x = np.arange(len(PAIRS))
    for k, (label, values) in enumerate(
        (("source", [SOURCE_DEG2[p] for p in PAIRS]), ("ours, tracked", ours), ("ours, true joints", truth))
    ):
        ax.bar(x + 0.27 * (k - 1), values, 0.25, label=label)
    ax.set_yscale("log")
    ax.set_xticks(x, PAIRS)
    ax.set_ylabel("variance of the angle [deg²]")
    ax.grid(axis="y", alpha=0.3)
    ax.legend()
    report.picture(save(figure, report_folder(folder) / "variances.png"), "Variance of six vectors' angles")
    report.write()


def report_folder(folder: Path) -> Path:
    """The folder, made when missing."""
    folder.mkdir(parents=True, exist_ok=True)
    return folder
